#!/usr/bin/python3
"""Every format of `accdec export` read back, compiled or run by something that is not accdec.

exports.py ACCDEC PROBLEMS: C by gcc, the LinuxCNC component by gcc with stand-ins for the macros of halcompile (and by
halcompile itself where it is installed), NumPy by numpy, the .m file by octave where it is installed and by a parser of
its own, the others by parsers. Structured Text is read back, not run. Titles and names are hostile on purpose.
"""
import configparser
import csv
import io
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy

accdec, problems = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
folder = pathlib.Path(tempfile.mkdtemp())

title = 'Fr\u00e4se "q" \'x\' */ (* *) /* ??/ \\ $N %s %{ # \u52a0\u5de5 \U0001f600 \u202e ;; """ end\\'
names = ['A "1", b', "*/ \u00df ' $$ # \\"]
corner = 'angle_deg = 90\nfeed_in_mm_min = 6000\nerror_max_um = 50\n'
task = (f"title = {json.dumps(title, ensure_ascii=False)}\nsample_period_ms = 1\n[filter]\nkind = 'averages'\nlengths = [9, 4]\n"
        "[[axis]]\nacceleration_max_mm_s2 = 20000\njerk_max_mm_s3 = 1e7\n[[mode]]\nfrequency_Hz = [100, 110]\n"
        f"residual_max = 0.9\n" + "".join(f"[[corner]]\nname = {json.dumps(n, ensure_ascii=False)}\n{corner}" for n in names))
limits = [("acceleration", "x", 20000, "mm/s^2"), ("jerk", "x", 1e7, "mm/s^3"), ("acceleration", "y", 20000, "mm/s^2"),
          ("jerk", "y", 1e7, "mm/s^3"), ("vibration", "", 90, "%"), ("corner_error", "", 50, "um"),
          ("corner_error", "", 50, "um")]
expected_taps = numpy.convolve(numpy.ones(9) / 9, numpy.ones(4) / 4)


def run(*arguments, code=0, folder=folder):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, cwd=folder, timeout=300)
    if code is not None and done.returncode != code:
        raise AssertionError(f"{arguments} gave {done.returncode}: {done.stderr.decode()}")
    return done


def export(format, result="result.json"):
    return run(accdec, "export", result, "--format", format).stdout


def made(text, name="task.toml", result="result.json", command="design"):
    (folder / name).write_text(text, encoding="utf-8")
    run(accdec, "--quiet", command, name, "--json", result, code=None if command == "evaluate" else 0)
    return json.loads((folder / result).read_text(encoding="utf-8"))


def compiled(source, name, *includes):
    (folder / f"{name}.c").write_bytes(source)
    run("gcc", "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", *includes, f"{name}.c", "-o", name)
    return run(folder / name).stdout.decode()


def signal():
    """Positions of an axis that jerks about, far from zero."""
    return 1000 + numpy.cumsum(numpy.random.default_rng(1).uniform(-1, 1, 200))


def filtered(positions, taps):
    """By numpy, from rest at the first position."""
    long = numpy.concatenate([numpy.full(len(taps) - 1, positions[0]), positions])
    return numpy.convolve(long, taps, mode="valid")


class Exports(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.result = made(task)
        cls.delays = [c["delay_samples"] for c in cls.result["corners"]]
        cls.commit = run(accdec, "--version").stdout.decode().splitlines()[1].removeprefix("commit ")

    def same_taps(self, taps):
        numpy.testing.assert_array_equal(numpy.array(taps, float), self.result["filter"]["taps"])
        numpy.testing.assert_allclose(taps, expected_taps, rtol=1e-14)

    def test_json(self):
        told = json.loads(export("json"))
        self.same_taps(told["taps"])
        self.assertEqual(told["title"], title)
        self.assertEqual([c["name"] for c in told["corners"]], names)
        self.assertEqual([c["delay_samples"] for c in told["corners"]], self.delays)
        self.assertEqual(told["commit"], self.commit)
        self.assertEqual([(l["kind"], l.get("axis", ""), l["bound"], l["unit"]) for l in told["limits"]], limits)
        worst = max(u["utilisation"] for u in self.result["limits"] if u["kind"] == "jerk" and u["axis"] == "x")
        self.assertEqual(told["limits"][1]["used"], worst)
        self.assertEqual(told["limits"][4]["frequency_Hz"], [100, 110])

    def test_settings_are_in_every_format(self):
        text = ("sample_period_ms = 1\n[controller]\nname = 'sinumerik-840d'\ndelays = 'in-position'\n[[axis]]\n"
                f"acceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n[[corner]]\nname = 'A'\n{corner}")
        settings = made(text, "settings.toml", "settings.json")["settings"]
        values = [(v["name"], v["value"]) for v in settings["values"]]
        self.assertEqual([name.split()[0] for name, _ in values], ["MD32410", "MD32411"])
        width = settings["width_m"]
        for form in ("c", "m", "st", "q15", "q31", "linuxcnc-comp"):
            told = dict(re.findall(r"set: (.*?) = (\S+)", export(form, "settings.json").decode()))
            self.assertEqual([(n, float(told[n])) for n, _ in values], values, form)
            self.assertAlmostEqual(float(told["in-position width"]), 1e6 * width, delta=1e-8 * width * 1e6)
            self.assertEqual((told["family"], told["delay of corner A"]), ("averages", "in-position"), form)
        rows = [r for r in csv.reader(line[2:] for line in export("csv", "settings.json").decode().splitlines()
                                      if line.startswith("# ")) if r[0] == "set"]
        told = {name: value for _, name, where, value, _ in rows if not where}
        self.assertEqual([(n, float(told[n])) for n, _ in values], values)
        self.assertIn(["set", "delay", "A", "in-position", ""], rows)
        (folder / "settings.npy").write_bytes(export("npy", "settings.json"))
        with open(folder / "settings.npy", "rb") as file:
            about = [numpy.load(file) for _ in range(3)][2].item()
        for told in (*(json.loads(export(form, "settings.json")) for form in ("json", "cascade")), json.loads(about)):
            self.assertEqual([(v["name"], v["value"]) for v in told["settings"]], values)
            self.assertEqual((told["family"], told["corners"][0]["delay_by"]), ("averages", "in-position"))
            self.assertEqual(told["in_position_width_m"], width)

    def test_csv(self):
        text = export("csv").decode()
        self.same_taps(numpy.loadtxt(io.StringIO(text), delimiter=",", skiprows=1)[:, 1])
        rows = list(csv.reader(line[2:] for line in text.splitlines() if line.startswith("# ")))
        self.assertIn(["title", title], rows)
        self.assertEqual([r[1:] for r in rows if r[0] == "delay_samples"],
                         [[n, str(d)] for n, d in zip(names, self.delays)])
        self.assertEqual([(r[1], r[2], float(r[4]), r[5]) for r in rows if r[0] == "limit"], limits)
        self.assertIn(["commit", self.commit], rows)

    def test_npy(self):
        (folder / "taps.npy").write_bytes(export("npy"))
        self.same_taps(numpy.load(folder / "taps.npy"))
        with open(folder / "taps.npy", "rb") as file:
            self.same_taps(numpy.load(file))
            self.assertEqual(numpy.load(file).tolist(), self.delays)
            about = json.loads(numpy.load(file).item())
            self.assertEqual(file.read(), b"")
        self.assertEqual((about["title"], about["commit"], len(about["limits"])), (title, self.commit, len(limits)))

    def test_cascade(self):
        told = json.loads(export("cascade"))
        self.assertEqual(told["moving_average_lengths"], [9, 4])
        self.assertEqual([c["delay_samples"] for c in told["corners"]], self.delays)
        self.assertEqual((told["title"], told["commit"], len(told["limits"])), (title, self.commit, len(limits)))

    def test_c(self):
        (folder / "taps.h").write_bytes(export("c"))
        told = compiled(b"""#include <stdio.h>
#include "taps.h"
int main(void) {
  int i;
  const char *c;
  printf("%.17g %d %d", ACCDEC_SAMPLE_PERIOD_S, ACCDEC_ORDER, ACCDEC_CORNERS);
  for (i = 0; i <= ACCDEC_ORDER; i++) printf("%s%.17g", i ? " " : "\\n", accdec_taps[i]);
  for (i = 0; i < ACCDEC_CORNERS; i++) {
    printf("\\n%d ", accdec_delays[i]);
    for (c = accdec_corner_names[i]; *c; c++) printf("%02x", (unsigned)(unsigned char)*c);
  }
  printf("\\n");
  for (c = accdec_title; *c; c++) printf("%02x", (unsigned)(unsigned char)*c);
  printf("\\n%s\\n", accdec_commit);
  return 0;
}
""", "header").splitlines()
        self.assertEqual(told[0], f"0.001 11 2")
        self.same_taps([float(t) for t in told[1].split()])
        self.assertEqual(told[2:4], [f"{d} {n.encode().hex()}" for n, d in zip(names, self.delays)])
        self.assertEqual(bytes.fromhex(told[4]).decode(), title)
        self.assertEqual(told[5], self.commit)
        self.assertIn("limit: jerk x 10000000 mm/s^3", (folder / "taps.h").read_text("ascii"))

    def test_linuxcnc_component(self):
        text = export("linuxcnc-comp").decode("ascii")
        head, code = text.split("\n;;\n")
        self.assertRegex(head, r"^component accdec_filter ")
        variables = "".join(f"static {v};\n" for v in re.findall(r"^variable (.*);$", head, re.M))
        positions = signal()
        stand_in = (f"#include <stdio.h>\nstatic double in, out;\nstatic int load;\n{variables}"
                    f"#define FUNCTION(name) static void run(void)\n{code}\n"
                    "int main(void) {\n  static const double way[] = {" +
                    ", ".join(map(repr, map(float, positions))) + "};\n  int i;\n"
                    "  for (i = 0; i < 200; i++) { in = way[i]; load = i == 150; run(); printf(\"%.17g\\n\", out); }\n"
                    "  return 0;\n}\n")
        told = [float(x) for x in compiled(stand_in.encode(), "component").split()]
        taps = self.result["filter"]["taps"]
        numpy.testing.assert_allclose(told[:150], filtered(positions[:150], taps), rtol=0, atol=1e-11)
        # At `load` the past is forgotten.
        numpy.testing.assert_allclose(told[150:], filtered(positions[150:], taps), rtol=0, atol=1e-11)
        for n, d in zip(names, self.delays):
            self.assertIn(f"delay: {d} samples at corner", code)
        self.assertIn(self.commit, code)
        if shutil.which("halcompile"):
            (folder / "accdec_filter.comp").write_text(text)
            run("halcompile", "--compile", "accdec_filter.comp")
        else:
            print("halcompile is not installed; the component ran with stand-ins for its macros")

    def test_matlab(self):
        text = export("m").decode("ascii")
        taps = re.search(r"accdec\.taps = \[\n(.*?)\];", text, re.S)[1]
        self.same_taps([float(t) for t in taps.split()])
        delays = re.search(r"accdec\.delays = \[\n(.*?)\];", text, re.S)[1]
        self.assertEqual([int(d) for d in delays.split()], self.delays)
        bytes_of = re.search(r"accdec\.title = native2unicode\(uint8\(\[(.*?)\]\), 'UTF-8'\);", text)[1]
        self.assertEqual(bytes(map(int, bytes_of.split())).decode(), title)
        self.assertIn(f"accdec.commit = '{self.commit}';", text)
        for line in text.splitlines():
            self.assertNotRegex(line.strip(), r"^[%#][{}]$", "would begin a block comment")
        if not shutil.which("octave"):
            print("octave is not installed; the .m file was parsed only")
            return
        (folder / "taps.m").write_text(text)
        told = run("octave", "--no-gui", "--quiet", "--eval",
                   'taps; printf("%.17g\\n", accdec.taps); printf("%d\\n", accdec.delays);'
                   'printf("%02x", uint8(accdec.title)); printf("\\n%d %d\\n", size(accdec.limits))').stdout.split()
        self.same_taps([float(t) for t in told[:12]])
        self.assertEqual([int(d) for d in told[12:14]], self.delays)
        self.assertEqual(bytes.fromhex(told[14].decode()).decode(), title)
        self.assertEqual([int(n) for n in told[15:]], [len(limits), 6])

    def test_structured_text(self):
        text = export("st").decode("ascii")
        self.assertIn("Not run on a control", text)
        code = re.sub(r"\(\*.*?\*\)", "", text, flags=re.S)
        self.assertNotRegex(code, r"\(\*|\*\)", "a comment ends early")

        def string(literal):
            return bytes.fromhex(re.sub(r"\$([0-9A-F]{2})|([^$])", lambda m: m[1] or f"{ord(m[2]):02x}", literal)).decode()

        taps = re.search(r"Taps : ARRAY\[0\.\.11\] OF LREAL := \[(.*?)\];", code, re.S)[1]
        self.same_taps([float(t) for t in taps.split(",")])
        delays = re.search(r"Delays : ARRAY\[1\.\.2\] OF DINT := \[(.*?)\];", code, re.S)[1]
        self.assertEqual([int(d) for d in delays.split(",")], self.delays)
        self.assertEqual(string(re.search(r"Title : STRING\(\d+\) := '([^']*)';", code)[1]), title)
        corners = re.search(r"Corners : ARRAY.*? := \[(.*?)\];", code, re.S)[1]
        self.assertEqual([string(n) for n in re.findall(r"'([^']*)'", corners)], names)
        self.assertIn(self.commit, text)
        for word, end in [("FOR", "END_FOR"), ("IF", "END_IF"), ("FUNCTION_BLOCK", "END_FUNCTION_BLOCK")]:
            self.assertEqual(len(re.findall(rf"\b{word}\b", code)), len(re.findall(rf"\b{end}\b", code)), word)
        self.assertEqual(len(re.findall(r"^VAR\b", code, re.M)) + len(re.findall(r"^VAR_", code, re.M)),
                         len(re.findall(r"^END_VAR", code, re.M)))

    def test_klipper(self):
        shaper = task.replace("[9, 4]", "[1]\nshaper = 'zv'\nshaper_delay = 12").replace("20000", "1e6")
        made(shaper.replace("1e7", "1e10"), "zv.toml", "zv.json")
        config = configparser.RawConfigParser(delimiters=(":",), inline_comment_prefixes=("#",), strict=True)
        text = export("klipper", "zv.json").decode("ascii")
        config.read_string(text)
        section = config["input_shaper"]
        # klippy/extras/shaper_defs.py: the second impulse of zv comes half a period after the first.
        self.assertEqual((section["shaper_type_x"], section["damping_ratio_y"]), ("zv", "0"))
        self.assertAlmostEqual(0.5 / float(section["shaper_freq_y"]), 0.012, places=11)
        self.assertIn(self.commit, text)
        # Klipper interpolates: the frequency need not make whole samples.
        for name, delay, periods in [("zv", 12.25, 0.5), ("mzv", 9.3, 0.375), ("ei", 11.6, 0.5)]:
            split = shaper.replace("1e7", "1e10").replace("residual_max = 0.9", "residual_max = 1")
            split = split.replace("'zv'", f"'{name}'").replace("= 12", f"= {delay}")
            made(split, "split.toml", "split.json")
            config.read_string(export("klipper", "split.json").decode("ascii"))
            self.assertEqual(config["input_shaper"]["shaper_type_x"], name)
            self.assertAlmostEqual(periods / float(config["input_shaper"]["shaper_freq_y"]), delay / 1e3, places=11)
        refused = run(accdec, "export", "result.json", "--format", "klipper", code=2)
        self.assertIn(b"no input shaper of Klipper", refused.stderr)

    def whole_taps(self, format, bits, result="result.json"):
        """The coefficients that a C program sees."""
        (folder / "taps_q.h").write_bytes(export(format, result))
        told = compiled(f"""#include <stdio.h>
#include "taps_q.h"
int main(void) {{
  int i;
  for (i = 0; i <= ACCDEC_ORDER; i++) printf("%ld\\n", (long)accdec_taps_{format}[i]);
  printf("%d %d\\n", accdec_delays[0], (int)sizeof accdec_taps_{format}[0]);
  return 0;
}}
""".encode(), "whole").split()
        self.assertEqual(sum(map(int, told[:-2])), 2**bits)
        self.assertEqual(int(told[-1]), (bits + 1) // 8)
        return [int(t) for t in told[:-2]], int(told[-2])

    def test_fixed_point(self):
        for format, bits in [("q15", 15), ("q31", 31)]:
            whole, delay = self.whole_taps(format, bits)
            self.assertEqual(delay, self.delays[0])
            numpy.testing.assert_allclose(whole, expected_taps * 2**bits, rtol=0, atol=2)
            self.assertIn(b"Rounded by this export", export(format))

    def test_fixed_point_under_tight_limits(self):
        text = (problems / "corner" / "acceleration-jerk.toml").read_text()
        design = "[design]\ncoefficient_bits = 15\n"
        result = made(text.replace("[[axis]]", design + "[[axis]]", 1), "whole.toml", "whole.json")
        whole, _ = self.whole_taps("q15", 15, "whole.json")
        self.assertEqual(whole, result["quantisation"]["coefficients"])
        self.assertEqual([w / 2**15 for w in whole], result["filter"]["taps"])
        self.assertIn(b"The design's own taps, exactly", export("q15", "whole.json"))
        self.assertEqual(self.whole_taps("q31", 31, "whole.json")[0], [w * 2**16 for w in whole])
        self.assertEqual(json.loads(export("json", "whole.json"))["coefficients"], whole)
        # v/T^2 times the largest step, 0.1 m/s along the axis at most, of taps between zeros: at most 500 m/s^3.
        steps = numpy.diff([0] + whole + [0]) / 2**15
        self.assertLessEqual(0.1 * abs(steps).max() / 1e-6, 500 * (1 + 1e-9))
        run(accdec, "--quiet", "verify", "whole.json")

    def test_free_taps_at_their_limits_have_a_fixed_point_form(self):
        cases = [("acceleration-jerk", "q31", 31), ("exact-stop", "q31", 31), ("exact-stop", "q15", 15)]
        for name, format, bits in cases:
            text = (problems / "corner" / f"{name}.toml").read_text()
            free = made(text, "tight.toml", "tight.json")
            self.assertIn(b"Designed again by this export", export(format, "tight.json"))
            whole, delay = self.whole_taps(format, bits, "tight.json")
            self.assertEqual(len(whole), len(free["filter"]["taps"]))
            self.assertEqual(delay, free["corners"][0]["delay_samples"])
            # These taps and the delay as any given filter's.
            given = f"[filter]\nkind = 'taps'\ntaps = {[w / 2**bits for w in whole]}\n[[axis]]"
            judged = made(text.replace("[[axis]]", given, 1) + f"\ndelay_samples = {delay}\n", "given.toml",
                          "given.json", "evaluate")
            # The head tells how far these taps use each limit, not how far those of the result did.
            told = re.findall(r"limit: acceleration (\w) .*?, (\S+) % used", export(format, "tight.json").decode())
            self.assertTrue(told)
            for axis, used in told:
                uses = [u["utilisation"] for u in judged["limits"] if (u["kind"], u["axis"]) == ("acceleration", axis)]
                self.assertAlmostEqual(float(used), 100 * max(uses), delta=0.01)

    def test_a_refused_fixed_point_form_names_the_key(self):
        made((problems / "corner" / "acceleration-jerk.toml").read_text(), "tight.toml", "tight.json")
        told = run(accdec, "export", "tight.json", "--format", "q15", code=2).stderr
        self.assertIn(b"write `coefficient_bits = 15` below [design] in the task", told)

    def test_program(self):
        program = problems / "program"
        run(accdec, "--quiet", "program", program / "legs.ngc", "--task", program / "legs.toml", "--json", "part.json")
        part = json.loads((folder / "part.json").read_text())
        told = json.loads(export("json", "part.json"))
        joints = [d for d, joint in zip(part["commands"]["delay_samples"], part["commands"]["joint"]) if joint != "."]
        self.assertEqual([c["delay_samples"] for c in told["corners"]], joints)
        self.assertRegex(told["corners"][0]["name"], r"^line \d+$")

    def test_broken_limits_are_told(self):
        made(task.replace("20000", "2000").replace("error_max_um = 50", "delay_samples = 3"), "broken.toml",
             "broken.json", "evaluate")
        for format in ["c", "m", "st", "linuxcnc-comp"]:
            self.assertIn(b"NOT all limits hold: acceleration", export(format, "broken.json"))
        self.assertIn(b"# status,failed", export("csv", "broken.json"))
        self.assertEqual(json.loads(export("json", "broken.json"))["status"], "failed")


if __name__ == "__main__":
    try:
        unittest.main(argv=sys.argv[:1] + sys.argv[3:])
    finally:
        shutil.rmtree(folder)
