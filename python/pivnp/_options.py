"""Options of a case as Python has them: nested dictionaries, to TOML and to KEY=VALUE."""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np


def _text(value: str) -> str:
    escaped = "".join(f"\\u{ord(c):04X}" if ord(c) < 32 or ord(c) == 127 else "\\" + c if c in '"\\' else c for c in value)
    return f'"{escaped}"'


def value_text(value: Any) -> str:
    """One value as TOML, with the same bits."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, Sequence) and not isinstance(value, (str, bytes)):
        return "[" + ", ".join(value_text(v) for v in value) + "]"
    return _text(str(value))


def keys(options: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys with their values; None stands for a key that is left out."""
    for name, value in options.items():
        if isinstance(value, Mapping):
            yield from keys(value, f"{prefix}{name}.")
        elif value is not None:
            yield prefix + name, value


def settings(options: Mapping[str, Any]) -> list[str]:
    """As --set takes them: "piv.window_px=24"."""
    return [f"{key}={value_text(value)}" for key, value in keys(options)]


def _key(name: str) -> str:
    return name if name and all(c.isalnum() and c.isascii() or c in "_-" for c in name) else _text(name)


def to_toml(options: Mapping[str, Any], path: str = "") -> str:
    """A case as text: its own keys first, then its sections."""
    lines = [f"[{path}]\n"] if path else []
    lines += [f"{_key(name)} = {value_text(value)}\n" for name, value in options.items()
              if value is not None and not isinstance(value, Mapping)]
    for name, value in options.items():
        if isinstance(value, Mapping):
            lines.append(to_toml(value, f"{path}.{_key(name)}" if path else _key(name)))
    return "".join(lines)
