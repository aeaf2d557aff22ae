# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Where a view is shown: a window, a web page of this machine, or a file."""

from __future__ import annotations

import os
from pathlib import Path
import sys
from typing import Any

from .rerun_sdk import require_rerun
from .view import blueprint, ContactView

WINDOW, WEB = 'window', 'web'
_MEMORY = '1GiB'  # of the viewer and of what a page that opens late still gets


def show(view: ContactView, target: str, follow_s: float | None = None) -> str:
    """Connect a view to where it is shown."""
    layout = blueprint(follow_s)
    if target == WINDOW and has_display():
        rerun = require_rerun()
        rerun.spawn(recording=view.stream, default_blueprint=layout, memory_limit=_MEMORY,
                    executable_path=_executable(), hide_welcome_screen=True)
        text = 'opened the viewer'
    elif target in (WINDOW, WEB):
        text = serve(view, layout)
        if target == WINDOW:
            text = f'no display; {text}'
    else:
        view.stream.save(target, default_blueprint=layout)
        text = f'writing {target}; open it with: rerun {target}'
    view.stream.send_blueprint(layout)
    view.style()
    return text


def has_display() -> bool:
    """Return whether a window can be opened."""
    if sys.platform != 'linux':
        return True
    return bool(os.environ.get('DISPLAY') or os.environ.get('WAYLAND_DISPLAY'))


def serve(view: ContactView, layout: Any) -> str:
    view.serves = True
    address = view.stream.serve_grpc(
        default_blueprint=layout, server_memory_limit=_MEMORY)
    require_rerun().serve_web_viewer(open_browser=False, connect_to=address)
    page = f'http://localhost:9090/?url={address.replace(":", "%3A").replace("/", "%2F")}'
    return f'serving {page.replace("+", "%2B")}'


def _executable() -> str | None:
    """Return the viewer beside this Python, which need not be on PATH."""
    path = Path(sys.executable).with_name('rerun')
    return str(path) if path.exists() else None
