"""Runs a study or a comparison in a process of its own, which has no threads when the library forks its children.

Started by `_study` as a script: it sees the compiled module alone. Writes a JSON object a line: progress, at last the
answer or the error.
"""

import json
import signal
import sys
from typing import Any, Mapping


def say(message: Mapping[str, Any]) -> None:
    print(json.dumps(message), flush=True)


def main() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    request = json.loads(sys.argv[1])
    sys.path.insert(0, request["folder"])
    import _core

    def progress(done: int, total: int, seconds: float) -> None:
        say({"progress": [done, total, seconds]})

    try:
        say({"answer": getattr(_core, request["call"])(**request["arguments"], progress=progress)})
    except _core.InputError as error:
        say({"error": "InputError", "text": str(error), "attributes": {
            name: getattr(error, name) for name in ("file", "line", "column", "message", "pointer")}})
    except Exception as error:
        say({"error": type(error).__name__, "text": str(error), "attributes": {}})


if __name__ == "__main__":
    main()
