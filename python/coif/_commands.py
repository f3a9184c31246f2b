"""The editor's commands as methods: what editor.extrude, help(editor.extrude) and dir(editor) give."""

from __future__ import annotations

import functools


@functools.cache
def _infos():
    from . import _coif  # which looks in here in turn

    return {info["name"]: info for info in _coif.editor_commands()}


def method(editor, name):
    """The command of that name, to be called with its arguments by keyword."""
    if name not in _infos():
        raise AttributeError(f"the editor has no command '{name}'")
    info = _infos()[name]

    def command(**arguments):
        return editor.run(name, **arguments)

    command.__name__ = command.__qualname__ = name
    command.__doc__ = info["help"] + "".join(f"\n\n{a}: {text}" for a, text in info["arguments"].items())
    return command


def listed(editor):
    """What dir(editor) lists: its own attributes and every command."""
    return [*object.__dir__(editor), *_infos()]
