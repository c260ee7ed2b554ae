"""Damaged input to whole runs: `programs.py [runs] [seed]`, the program in STICKSLIP_BINARIES.

Every run ends in time with status 2 and a message, or is taken (status 0, 3 or 4); one that is
refused leaves every file as it was. Mostly -plan, which reads everything and computes nothing.
"""

import collections
import os
import pathlib
import random
import subprocess
import sys
import tempfile

PROGRAM = pathlib.Path(os.environ["STICKSLIP_BINARIES"]).resolve() / "stickslip"
SCENE = ("-mu_d", "0.25", "-delta", "0.5", "-accuracy", "0.1")
PATIENCE = 60  # seconds
WORDS = ["0", "-1", "1e308", "1e-320", "nan", "inf", "full", "expression", "-help", "-mu_d", "-tau",
         "-delta", "-noise_levels", "-drag", "-quantities", "-lambda", "-sweep_tau", "-bias", "1,2",
         "1:2:3", "#", '"', "'", "\\", "-options_file", "-slide_pc_type", "[", "{", "\0", "\xff",
         "=", "-v*v", "((", "-prefix_push", "-route", "monte_carlo", "-study", "p", "\t", "\r\n"]


def damaged(data, chance):
    """Bytes with a few pieces changed, removed, repeated or replaced by words."""
    data = bytearray(data)
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        at = chance.randrange(len(data) + 1)
        end = min(len(data), at + chance.randrange(12))
        word = chance.choice(WORDS).encode("latin-1")
        if at < len(data) and chance.random() < 0.3:
            data[at] ^= 1 << chance.randrange(8)
        else:
            data[at:end] = chance.choice((b"", word, b" " + word + b" ", data[at:end] * 2))
    return bytes(data)


def seeds(folder):
    """Sound input: name of a file, what it is damaged as, options that read it."""
    run = lambda *options: subprocess.run([PROGRAM, *SCENE, *options], cwd=folder, check=True,
                                          capture_output=True, timeout=PATIENCE)
    run("-quantities", "sticking,laplace", "-lambda", "0.5,2", "-summary", "seed.json", "-output",
        "seed.h5")
    run("-route", "monte_carlo", "-excursions", "16384", "-checkpoint", "seed.checkpoint")
    run("-sweep_tau", "0.5,1", "-checkpoint", "seed.record")
    (folder / "seed.csv").write_text("quantity,argument,value,low,high\nP_stick,,0.25,0.2,0.3\n"
                                     "F_slide,0.5,0.3,0.29,0.31\n")
    (folder / "seed.opts").write_text(
        "# scene\n-mu_d 0.25\n-delta 0.5\n-drag expression\n-drag_expression \" -v - v^3\"\n"
        "-quantities sticking,resolvent\n-lambda 0.1:1:3:log\n-observable \"v^2; stick\"\n")
    return [("seed.opts", ("-options_file", "FILE", "-plan")),
            ("seed.csv", (*SCENE, "-plan", "-compare", "FILE")),
            ("seed.json", (*SCENE, "-plan", "-compare", "FILE")),
            ("seed.h5", (*SCENE, "-plan", "-compare", "FILE")),
            ("seed.checkpoint", (*SCENE, "-route", "monte_carlo", "-excursions", "16384",
                                 "-checkpoint", "FILE")),
            ("seed.record", (*SCENE, "-sweep_tau", "0.5,1", "-checkpoint", "FILE")),
            (None, ("-mu_s", "1", "-mu_d", "0.5", "-delta", "0.5", "-bias", "0.1", "-plan")),
            (None, ("-drag", "expression", "-drag_expression", "-v*abs(v)", "-delta", "0.5",
                    "-tau", "1", "-plan"))]


def input_of(seed, folder, chance):
    """Writes damaged input; the options that read it."""
    name, options = seed
    if name is None:
        at = chance.randrange(len(options))
        word = damaged(options[at].encode(), chance).replace(b"\0", b"").decode("latin-1")
        return [*options[:at], word, *options[at + 1:]]
    file = folder / ("damaged" + pathlib.Path(name).suffix)
    file.write_bytes(damaged((folder / name).read_bytes(), chance))
    return [str(file) if word == "FILE" else word for word in options]


def contents(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir()}


def fault(done, before, after):
    """What is wrong with how a run ended; empty if nothing."""
    if done.returncode not in (0, 2, 3, 4):
        return f"status {done.returncode}"
    if any(".part" in name for name in after):
        return "a file was left half written"
    if done.returncode != 2:
        return ""
    if not done.stderr.startswith(b"stickslip: "):
        return "no message"
    return "files were changed" if after != before else ""


def main():
    runs, number = (int(word) for word in (sys.argv[1:] + ["300", "1"])[:2])
    chance, counts, faults = random.Random(number), collections.Counter(), 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        sound = seeds(folder)
        for n in range(runs):
            options = input_of(sound[n % len(sound)], folder, chance)
            command = [PROGRAM, *options, "-summary", "kept.json"]
            (folder / "kept.json").write_text("precious")
            before = contents(folder)
            try:
                done = subprocess.run(command, cwd=folder, capture_output=True, timeout=PATIENCE)
                wrong = fault(done, before, contents(folder))
                counts[done.returncode] += 1
            except subprocess.TimeoutExpired:
                wrong = "no end"
            if not wrong:
                continue
            faults += 1
            print(f"run {n}, {wrong}: {options}\n{done.stderr.decode('latin-1')[-500:]}")
    print(f"{runs} runs, {faults} faults; by status:", dict(sorted(counts.items())))
    sys.exit(1 if faults else 0)


main()
