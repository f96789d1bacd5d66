"""Says what the certificates of results of `accdec design` prove. Exit 0: all hold; 1: one does not; 2: not opened."""
import argparse
import sys

sys.dont_write_bytecode = True
from claim import check  # noqa: E402
from enclosure import NotCovered, Refused  # noqa: E402

parser = argparse.ArgumentParser(prog="python3 apps/check_certificate", description=__doc__)
parser.add_argument("results", nargs="+", metavar="RESULT.json")
worst = 0
sys.setrecursionlimit(20000)
for file in parser.parse_args().results:
    try:
        with open(file, encoding="utf-8") as opened:
            print(f"{file}: proved: {check(opened.read())}")
    except Refused as reason:
        print(f"{file}: {'not covered' if isinstance(reason, NotCovered) else 'refused'}: {reason}")
        worst = max(worst, 1)
    except (OSError, UnicodeDecodeError) as error:
        print(f"{file}: {error}", file=sys.stderr)
        worst = 2
sys.exit(worst)
