#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# tests/install.sh leaves no service behind that runs or will run: with an apt-get and a dpkg-query of
# its own, which install a service as Debian's packages do, into a root of its own.
#
#   sh tests/install_services_test.sh ROOT
set -u
source=$(cd "$1" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
fail() { echo "FAILED: $*"; failures=$((failures + 1)); }

wants=$work/root/etc/systemd/system/multi-user.target.wants
mkdir -p "$work/bin" "$wants" "$work/root/etc/rc2.d" "$work/root/usr/sbin"
ln -s /lib/systemd/system/cron.service "$wants/cron.service" # the user's own, as it was
ln -s ../init.d/cron "$work/root/etc/rc2.d/S01cron"
cat >"$work/bin/dpkg-query" <<'END'
#!/bin/sh
exit 1
END
cat >"$work/bin/apt-get" <<'END'
#!/bin/sh
case " $* " in *" install "*) ;; *) exit 0 ;; esac
# What a package's script does: enables its service, and starts it unless policy-rc.d forbids that.
ln -s /lib/systemd/system/slurmd.service "$DESTDIR/etc/systemd/system/multi-user.target.wants/"
ln -s ../init.d/munge "$DESTDIR/etc/rc2.d/S01munge"
sh "$DESTDIR/usr/sbin/policy-rc.d" slurmd start
[ $? -eq 101 ] || echo slurmd >>"$DESTDIR/started"
exit "${APT_FAILS:-0}"
END
cat >"$work/bin/id" <<'END'
#!/bin/sh
echo 0
END
chmod 755 "$work/bin"/*
export PATH="$work/bin:$PATH" DESTDIR="$work/root"

for code in 0 100; do # apt-get may fail half way
  APT_FAILS=$code sh "$source/tests/install.sh" tests >"$work/out" 2>&1
  [ $? -eq $code ] || fail "exit code other than apt-get's $code: $(cat "$work/out")"
  [ "$(ls "$wants")" = cron.service ] || fail "enabled: $(ls "$wants")"
  [ -z "$(find "$work/root/etc/rc2.d" -name 'S*munge')" ] || fail "munge starts at boot"
  [ -L "$work/root/etc/rc2.d/S01cron" ] || fail "the user's own service was switched off"
  [ ! -e "$work/root/started" ] || fail "started: $(cat "$work/root/started")"
  [ ! -e "$work/root/usr/sbin/policy-rc.d" ] || fail "policy-rc.d stays"
  rm -f "$work/root/etc/rc2.d"/*munge
done

# A policy of the user's own stays.
printf '#!/bin/sh\nexit 101\n' >"$work/root/usr/sbin/policy-rc.d"
sh "$source/tests/install.sh" tests >/dev/null 2>&1
[ -e "$work/root/usr/sbin/policy-rc.d" ] || fail "the user's policy-rc.d was removed"
[ "$failures" -eq 0 ]
