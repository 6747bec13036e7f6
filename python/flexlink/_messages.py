"""Errors and warnings, with the text and the hint of the command."""

from __future__ import annotations


class FlexlinkError(Exception):
    """An error of the command: ``message``, and ``hint`` with a remedy, or None."""

    message: str
    hint: str | None

    def __init__(self, message: str, hint: str | None = None) -> None:
        super().__init__(message if hint is None else f"{message}\nhint: {hint}")
        self.message = message
        self.hint = hint


class InputError(FlexlinkError, ValueError):
    """An input is refused."""


class NotSolvableError(FlexlinkError, RuntimeError):
    """Link and motion are valid, but there is no answer."""


class OutOfMemoryError(NotSolvableError, MemoryError):
    """An answer takes more memory than there is; the call took none of it."""


class WriteError(FlexlinkError):
    """Results cannot be written."""


class FlexlinkWarning(UserWarning):
    """A warning or a remark on a result: ``message``, ``hint``, and ``kind``, its name in summary.json."""

    message: str
    hint: str
    kind: str

    def __init__(self, message: str, hint: str = "", kind: str = "") -> None:
        super().__init__(f"{message}\nhint: {hint}" if hint else message)
        self.message = message
        self.hint = hint
        self.kind = kind
