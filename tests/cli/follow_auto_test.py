# SPDX-License-Identifier: GPL-3.0-or-later
# Folds of a Duffing oscillator, and their curve over the force, by strut path --periodic and by AUTO-07p (Debian's
# auto-07p), which discretises the same periodic motion by collocation. Skipped where AUTO or gfortran is not installed.
import math
import re
import shutil
import subprocess

from periodic import DUFFING, follow, special
from testing import check, finish, needs, work, write

needs("auto-07p", "gfortran")

auto = shutil.which("auto-07p")

DAMPING, CUBIC, FORCE = 0.05, 0.05, 0.1  # of DUFFING
FROM, TO = 0.14, 0.22  # [Hz]

result = follow(DUFFING, f"frequency={FROM}Hz..{TO}Hz", "--and", "force=0.05N..0.2N")
ours = [p["value"] for p in special(result, "fold")]

# x' = v and so on over one period, and an oscillator that makes sin and cos of the drive
write("duf.f90", f"""subroutine FUNC(NDIM,U,ICP,PAR,IJAC,F,DFDU,DFDP)
  implicit none
  integer, intent(in) :: NDIM, ICP(*), IJAC
  double precision, intent(in) :: U(NDIM), PAR(*)
  double precision, intent(out) :: F(NDIM)
  double precision, intent(inout) :: DFDU(NDIM,NDIM), DFDP(NDIM,*)
  double precision :: period, rest
  period = 8d0*atan(1d0)/PAR(1)
  rest = 1d0 - U(3)**2 - U(4)**2
  F(1) = period*U(2)
  F(2) = period*(PAR(2)*U(3) - {DAMPING}d0*U(2) - U(1) - {CUBIC}d0*U(1)**3)
  F(3) = period*(PAR(1)*U(4) + U(3)*rest)
  F(4) = period*(-PAR(1)*U(3) + U(4)*rest)
end subroutine
subroutine STPNT(NDIM,U,PAR,T)
  implicit none
  integer, intent(in) :: NDIM
  double precision, intent(inout) :: U(NDIM), PAR(*)
  double precision, intent(in) :: T
  double precision :: w, a, p
  w = 8d0*atan(1d0)*{FROM}d0
  PAR(1) = w
  PAR(2) = {FORCE}d0
  a = {FORCE}d0/(1d0-w*w)
  p = 8d0*atan(1d0)*T
  U(1) = a*sin(p)
  U(2) = a*w*cos(p)
  U(3) = sin(p)
  U(4) = cos(p)
end subroutine
subroutine BCND(NDIM,PAR,ICP,NBC,U0,U1,FB,IJAC,DBC)
  implicit none
  integer, intent(in) :: NDIM, ICP(*), NBC, IJAC
  double precision, intent(in) :: PAR(*), U0(NDIM), U1(NDIM)
  double precision, intent(out) :: FB(NBC)
  double precision, intent(inout) :: DBC(NBC,*)
  FB(1) = U1(1)-U0(1)
  FB(2) = U1(2)-U0(2)
  FB(3) = U0(3)
  FB(4) = U0(4)-1d0
end subroutine
subroutine ICND
end subroutine
subroutine FOPT
end subroutine
subroutine PVLS
end subroutine
""")
write("c.duf", f"""NDIM=4, IPS=4, IRS=0, ILP=1
ICP=[1]
NTST=40, NCOL=4, IAD=3, ISP=0, ISW=1, IPLT=0, NBC=4, NINT=0
NMX=400, NPR=400, MXBF=0, IID=2, ITMX=9, ITNW=7, NWTN=3, JAC=0
EPSL=1e-08, EPSU=1e-08, EPSS=1e-07
DS=0.01, DSMIN=0.0001, DSMAX=0.05, IADS=1
RL0=0.7, RL1=1.5, A0=0, A1=1e6
UZSTOP={{1: {2 * math.pi * TO}}}
""")
write("duf.auto", """r = run('duf')
s = run(r('LP1'), ISW=2, ICP=[1, 2])
run(s, DS=0.01, UZR={2: [0.12, 0.15, 0.18]}, UZSTOP={2: [0.2, 0.05]})
run(s, DS=-0.01, UZR={2: [0.09, 0.12, 0.15, 0.18]}, UZSTOP={2: [0.2, 0.05]})
""")
done = subprocess.run([auto, "duf.auto"], capture_output=True, text=True, cwd=work, timeout=100,
                      stdin=subprocess.DEVNULL, check=False)
theirs = [float(v) / (2 * math.pi) for v in re.findall(r"^\s*\d+\s+\d+\s+LP\s+\d+\s+(\S+)", done.stdout, re.M)]
check(len(theirs) == 2, f"AUTO finds folds at {theirs}: {done.stdout[-500:]} {done.stderr[-500:]}")
check(len(ours) == 2, f"strut finds folds at {ours}")
for mine, other in zip(ours, theirs):
    check(abs(mine - other) <= 2e-5 * other, f"a fold at {mine} Hz, by AUTO at {other} Hz")

# the curve of folds at other forces: three points of it by Lagrange's formula
curve = [p["values"] for p in result["curves"][0]["points"]]
found = re.findall(r"^\s*\d+\s+\d+\s+UZ\s+\d+\s+(\S+)(?:\s+\S+){5}\s+(\S+)\s*$", done.stdout, re.M)
check(len(found) == 10, f"AUTO's curve: {found}")
for turn, force in ((float(a), float(b)) for a, b in found):
    if abs(force - 0.2) < 1e-6:
        continue
    nearest = []
    for k in range(1, len(curve) - 2):
        if (curve[k][1] - force) * (curve[k + 1][1] - force) > 0:
            continue
        value = sum(curve[i][0] * math.prod((force - curve[j][1]) / (curve[i][1] - curve[j][1])
                                            for j in range(k - 1, k + 2) if j != i) for i in range(k - 1, k + 2))
        nearest.append(abs(2 * math.pi * value / turn - 1))
    check(nearest and min(nearest) < 3e-5, f"AUTO's fold at {force} N, {turn / 2 / math.pi} Hz: off by {nearest}")
finish()
