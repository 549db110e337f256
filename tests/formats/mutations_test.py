# SPDX-License-Identifier: GPL-3.0-or-later
# Files to import with bytes that are deleted, doubled, replaced or moved: a scene that strut takes, or messages with
# places; never a traceback.
#
#   python3 mutations_test.py STRUT [FILES]        (with the Python package of the same build)
import contextlib
import io
import os
import random
import sys

from testing import check, finish, strut, work

sys.path.insert(0, os.path.join(os.path.dirname(strut), "python"))
from strut import loads  # noqa: E402
from strut.formats.__main__ import main  # noqa: E402

SEEDS = {
    "tensegritysim": b"nodes: {A: [0, 0], B: [1, 0]}\nconnections:\n  rope: [x: [A, B], [B, A]]\n"
                     b"builders:\n  rope: {stiffness: 1e2, type: string}\npin: {A: [True, True]}\n",
    "ntrt": b"nodes: {a: [-5, 0, 2], b: [5, 0, 2]}\npair_groups:\n  rod x: [[a, b]]\n  string: [[b, a]]\n"
            b"builders: {rod: {class: tgRodInfo, parameters: {density: 0.7}}}\n"
            b"substructures: {s/t: {path: ../file, offset: [1, 0, 0], rotation: {axis: [0, 0, 1], angle: 90}}}\n"
            b"bond_groups: {string: {s/t/node_node: [[a, b]]}}\n",
    "springable": b"PARAMETERS\nw, 8.0\nNODES\n0, 0, 0, 1, 1\n1, w/2, X0+1., 0, 0\n2, 2, 2, 1, 1\nSPRINGS\n"
                  b"0-1, k=w**2, SQRT(w)\n1-2, ZIGZAG2(u_i=[1; 2]; f_i=[2; 3]; epsilon=0.1; mode=-1)\nAREA SPRINGS\n"
                  b"0-1-2, ISENTROPIC(n=1;R=2;T0=3;gamma=1.4)\nPOINT2MID Y DISTANCE SPRINGS\n1-0-2, "
                  b"CONTACT(f0=1;uc=.1;delta=0)\nLOADING\n1, Y, 2, 1\nthen\nblock\n1, X\n1, Y, 1\n",
    "tables": b"node,x [mm],y,fixed\n\"A\",0,0,both\nB,1,1,\n",
}
OTHER = {"tables": b"member,kind,from,over,to,stiffness [N/m]\nm,bar,A,,B,1\n"}
GLYPHS = b"\n,;:-[]{}()'\"#*&!%|>\\.=0123456789eXYNa \t\x00\xff"


def mutate(text, draw):
    text = bytearray(text)
    for _ in range(draw.randint(1, 6)):
        i, length = draw.randrange(len(text) + 1), draw.randint(1, 8)
        piece = bytes(text[i:i + length])
        del text[i:i + length * draw.randint(0, 1)]
        text[i:i] = draw.choice((b"", piece, bytes([draw.choice(GLYPHS)])))
        if draw.random() < 0.2 and text:
            at = draw.randrange(len(text))
            text[at:at] = piece
    return bytes(text)


os.chdir(work)
draw = random.Random(20261129)
count = int(sys.argv[2]) if len(sys.argv) > 2 else 100
codes = {}
for reader, seed in SEEDS.items():
    for i in range(count):
        files = []
        for name, text in (("file", seed), ("other", OTHER.get(reader))):
            if text is not None:
                files.append(name)
                with open(name, "wb") as file:
                    file.write(mutate(text, draw) if name == "file" or draw.random() < 0.5 else text)
        said, scene = io.StringIO(), io.StringIO()
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(scene):
            code = main(["import", "--from", reader, *files])
        codes[code] = codes.get(code, 0) + 1
        if code == 0:
            loads(scene.getvalue())
        else:
            check(code == 2 and said.getvalue(), f"{reader} {i}: {code}: {said.getvalue()}")
check(len(codes) == 2, f"exit codes {codes}")
finish()
