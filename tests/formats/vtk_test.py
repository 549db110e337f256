# SPDX-License-Identifier: GPL-3.0-or-later
"""What `python3 -m strut.formats vtk` writes, read by VTK itself and compared with the run's CSV files.

usage: vtk_test.py STRUT
"""
import math
import os
import shutil
import xml.etree.ElementTree as ElementTree

from testing import check, files_in, finish, formats, needs, numbers, run, work, write

needs("vtkmodules")
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader  # noqa: E402

hopper = os.path.abspath("tests/cli/hopper.yaml")
with open(hopper, encoding="utf-8") as scene:
    HOPPER = scene.read()
os.chdir(work)


def read(path):
    reader = vtkXMLPolyDataReader()
    trouble = []
    reader.AddObserver("ErrorEvent", lambda *_: trouble.append(path))
    reader.SetFileName(path)
    reader.Update()
    check(not trouble, f"VTK cannot read {path}")
    return reader.GetOutput()


def datasets(directory):
    root = ElementTree.parse(os.path.join(directory, "structure.pvd")).getroot()
    check(root.tag == "VTKFile" and root.get("type") == "Collection", "the .pvd is no collection")
    return [(float(d.get("timestep")), int(d.get("part")), d.get("file")) for d in root.iter("DataSet")]


def names(data, which):
    array = data.GetFieldData().GetAbstractArray(which)
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())]


def column(data, which):
    array = data.GetArray(which)
    check(array is not None, f"no array {which}")
    return [array.GetTuple(i) for i in range(array.GetNumberOfTuples())]


def test_run():
    """Every frame: the same bits as nodes.csv, members.csv and contacts.csv."""
    run("run", hopper, "--quiet", "-o", "run")
    said = formats("vtk", "run", "-o", "vtk").stdout
    node_rows, member_rows = numbers("run/nodes.csv"), numbers("run/members.csv")
    contact_rows = numbers("run/contacts.csv")
    check(said.startswith(f"{len(node_rows)} frames"), said)
    listed = datasets("vtk")
    frames = [d for d in listed if d[1] == 0]
    check([d[0] for d in frames] == [r["time"] for r in node_rows], "times differ")
    check(all(d[2] == "ground.vtp" for d in listed if d[1] == 1), "the ground is not part 1")
    wanted = {"structure.pvd", "ground.vtp"} | {d[2] for d in frames}
    check(set(files_in("vtk")) == wanted, "files: " + str(set(files_in("vtk")) ^ wanted))
    first = read("vtk/" + frames[0][2])
    nodes, members = names(first, "node_names"), names(first, "member_names")
    check(nodes == ["foot", "body", "arm"] and members == ["leg", "rope", "stay"], "names")
    start = node_rows[0]
    touched = slack = 0
    for i in range(0, len(frames), 7):
        data, node, member, contact = (read("vtk/" + frames[i][2]), node_rows[i], member_rows[i], contact_rows[i])
        points, cells = data.GetPointData(), data.GetCellData()
        check(data.GetFieldData().GetArray("TimeValue").GetValue(0) == frames[i][0], "TimeValue")
        speed, moved = column(points, "velocity"), column(points, "displacement")
        push = column(points, "contact_force")
        for k, name in enumerate(nodes):
            x, y = node[name + ".x"], node[name + ".y"]
            check(data.GetPoint(k) == (x, y, 0), f"position of {name} at {frames[i][0]}")
            check(speed[k] == (node[name + ".vx"], node[name + ".vy"], 0), f"velocity of {name}")
            check(moved[k] == (x - start[name + ".x"], y - start[name + ".y"], 0), "displacement")
            check(push[k] == (contact.get(name + ".friction", 0), contact.get(name + ".normal", 0),
                              0), f"contact force of {name}")
            touched += push[k][1] > 0
        check(column(points, "node") == [(0,), (1,), (2,)], "node numbers")
        check(data.GetNumberOfCells() == 3, "cells")
        ends = [(0, 1), (1, 2), (0, 2)]
        for k, name in enumerate(members):
            cell = data.GetCell(k)
            check((cell.GetPointId(0), cell.GetPointId(1)) == ends[k], f"ends of {name}")
            check(cells.GetArray("force").GetValue(k) == member[name + ".force"], f"force of {name}")
            check(cells.GetArray("length").GetValue(k) == member[name + ".length"], "length")
        check(column(cells, "kind") == [(1,), (2,), (0,)], "kinds")
        loose = member["rope.force"] == 0
        check(column(cells, "slack") == [(0,), (float(loose),), (0,)], "slack")
        slack += loose
        strain = member["rope.length"] / 0.055 - 1
        check(abs(cells.GetArray("strain").GetValue(1) - strain) < 1e-14, "strain")
    check(touched and slack, "the run shows neither contact nor slack: no test")
    ground = read("vtk/ground.vtp")
    check(ground.GetBounds()[2:4] == (0, 0) and ground.GetNumberOfCells() == 1, "ground")


def test_model():
    """One frame, in the shape asked for; frames of an earlier export go."""
    formats("vtk", hopper, "-o", "vtk")
    check(sorted(files_in("vtk")) == ["ground.vtp", "structure.pvd", "structure_00000.vtp"],
          "stale frames: " + str(len(files_in("vtk"))))
    data = read("vtk/structure_00000.vtp")
    check(data.GetPoint(2) == (-0.05, 0.1, 0), "drawn")
    stay = math.hypot(0.05, 0.1)
    check(abs(data.GetCellData().GetArray("length").GetValue(2) - stay) < 1e-17, "length")
    force = data.GetCellData().GetArray("force").GetValue(1)
    check(abs(force - 200 * (0.06 - 0.055)) < 1e-13, f"force {force}")
    formats("vtk", hopper, "-o", "rest", "--at", "start")
    foot = read("rest/structure_00000.vtp").GetPoint(0)
    check(-1e-3 < foot[1] < 0, f"at rest the foot presses into the ground: {foot}")


def test_names_and_no_members():
    write("ball.yaml", "strut: 1\nnodes:\n  כדור: {position: [1, 2], mass: 1}\n  ü-1: {position: [3, 4], mass: 1}\n")
    formats("vtk", "ball.yaml", "-o", "ball")
    data = read("ball/structure_00000.vtp")
    check(names(data, "node_names") == ["כדור", "ü-1"], "names")
    check(data.GetNumberOfVerts() == 2 and data.GetPoint(1) == (3, 4, 0), "nodes alone")


def test_thinning():
    """Above ten thousand frames every so many-th is written, and that is said."""
    text = HOPPER.replace("every: 1 ms", "every: 0.02 ms").replace("step: 0.1 ms", "step: 0.02 ms")
    write("fine.yaml", text.replace("velocity, length, force, contact, energy", "force"))
    run("run", "fine.yaml", "--quiet", "-o", "fine")
    said = formats("vtk", "fine", "-o", "thin").stdout
    listed = [d for d in datasets("thin") if d[1] == 0]
    check(len(listed) == 8334 and "8334 frames" in said and "from 25001 recorded" in said, said)
    times = [r["time"] for r in numbers("fine/nodes.csv")]
    check([d[0] for d in listed] == times[::3], "which frames")
    check(read("thin/structure_00000.vtp").GetPointData().GetArray("velocity") is None, "velocity")


def test_trouble():
    for code, words, message in [
            (4, ["vtk", "vtk", "-o", "x"], "holds no run"),
            (4, ["vtk", "nowhere", "-o", "x"], "nowhere"),
            (1, ["vtk", "run"], "-o"),
            (1, ["stl", "run", "-o", "x"], "vtk"),
            (1, ["vtk", "run", "-o", "x", "--at", "drawn"], "--at"),
            (1, ["vtk", "run", "-o", "x", "--set", "a=1"], "--set"),
            (4, ["vtk", "run", "-o", hopper], hopper)]:
        said = formats(*words, code=code)
        check(message in said.stderr and not said.stdout, f"{words}: {said.stderr}")
        check(said.stderr.count("\n") <= 1, f"{words}: more than a sentence: {said.stderr}")
        check(not os.path.exists("x"), f"{words}: left something")
    os.mkdir("half")
    shutil.copy("run/scene.yaml", "half")
    check("holds no run" in formats("vtk", "half", "-o", "x", code=4).stderr, "half")
    shutil.copy("run/summary.json", "half")
    for table in (b"no table", b"time [s],foot.x [m]\n0,zero\n", b"\xff"):
        write("half/nodes.csv", table)
        check("nodes.csv" in formats("vtk", "half", "-o", "x", code=4).stderr, "half a table")
    os.mkdir("vtk/structure_00001.vtp")
    shutil.move("vtk/structure.pvd", "kept.pvd")
    formats("vtk", "run", "-o", "vtk", code=4)
    check(not os.path.exists("vtk/structure.pvd"), "a part of an export")
    write("still.yaml", HOPPER.replace("position, velocity, length, force", "force"))
    run("run", "still.yaml", "--quiet", "-o", "still")
    said = formats("vtk", "still", "-o", "x", code=4).stderr
    check("position" in said, said)


for test in [test_run, test_model, test_names_and_no_members, test_thinning, test_trouble]:
    test()
finish()
