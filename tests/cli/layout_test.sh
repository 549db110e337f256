#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The canonical layout: nothing is lost, of every model and every good file, however it was laid out.
models=$(realpath "$2")
unpack=$(realpath "$3")
language=$(realpath "$(dirname "$0")/../language")
. "$(dirname "$0")/lib.sh"

# laid_out BEFORE AFTER (texts for printf): the layout of one is the other, whose layout it is itself.
laid_out() {
  printf '%b' "$1" >before.yaml
  printf '%b' "$2" >wanted
  "$strut" check --layout - <before.yaml >got 2>err || fail "no layout of: $1"
  cmp -s wanted got || fail "layout of: $1"
  "$strut" check --layout - <got >again 2>err
  same got again
}
laid_out 'strut:   1\n' 'strut: 1\n'
laid_out 'strut: 1' 'strut: 1\n'
laid_out '\n\n# a\n\n\n\nstrut: 1 \n\n\n' '# a\n\nstrut: 1\n'
laid_out 'a: {b:  1 ,c: [ 1,2 ]  }\n' 'a: {b: 1, c: [1, 2]}\n'
laid_out 'a:\n    b:\n          c: 1\n    d: 2\n' 'a:\n  b:\n    c: 1\n  d: 2\n'
laid_out 'a:\n- 1\n-   b: 2\n    c: 3\nd: 4\n' 'a:\n  - 1\n  - b: 2\n    c: 3\nd: 4\n'
laid_out 'a:\n-\n  - 1\n  - 2\n- - 3\n' 'a:\n  -\n    - 1\n    - 2\n  - - 3\n'
# Lines within brackets.
laid_out 'a: {b: 1,\n c: 2}\n' 'a: {b: 1,\n    c: 2}\n'
laid_out 'a: [\n 1,\n      2\n ]\n' 'a: [\n  1,\n  2\n  ]\n'
laid_out 'a: [[1,\n2], [\n3]]\n' 'a: [[1,\n     2], [\n      3]]\n'
laid_out 'ä: {b: "ü",\n c: 2}\n' 'ä: {b: "ü",\n    c: 2}\n'
# Comments stay where they belong.
laid_out 'a: 1   # one\nb: 2 # two\n' 'a: 1   # one\nb: 2 # two\n'
laid_out 'a:\n    # of b\n    b: 1\n    # still in a\n# of c\nc: 2\n  # at the end\n' \
  'a:\n  # of b\n  b: 1\n  # still in a\n# of c\nc: 2\n# at the end\n'
laid_out 'a: # head\n      b: 1\n\n\n      # end of a\n#\n' 'a: # head\n  b: 1\n\n  # end of a\n#\n'
laid_out 'a: [1, # one\n2 # two\n]\n' 'a: [1, # one\n    2 # two\n    ]\n'
# Quotes, folded and literal texts, anchors.
laid_out "a: 'x''y  z'\nb: \"#  \\\\\\\\n\"\n" "a: 'x''y  z'\nb: \"#  \\\\\\\\n\"\n"
laid_out 'a: one\n      two\n\n      three\nb: 1\n' 'a: one\n  two\n\n  three\nb: 1\n'
laid_out 'a: >\n      one\n        two\n\n      three\nb: |-\n x\n' 'a: >\n  one\n    two\n\n  three\nb: |-\n  x\n'
laid_out 'a: &x   [1,2]\nb:   *x\nc: &y\n    d: 1\n' 'a: &x [1, 2]\nb: *x\nc: &y\n  d: 1\n'
laid_out 'a: 1\r\nb:\r\n    c: "x\r\n      y"\r\n# z\r\n' 'a: 1\nb:\n  c: "x\n    y"\n# z\n'

# What cannot be kept is refused, and what is no YAML is shown.
refused() { # TEXT MESSAGE
  printf '%b' "$1" >bad.yaml
  cp bad.yaml saved
  expect 2 check --fix bad.yaml
  out_empty
  err_has "$2"
  same saved bad.yaml
}
refused '? a\n: 1\n' "bad.yaml"
refused 'a: |+\n  x\n\n' "the layout of line 1 cannot be changed"
refused '---\na: 1\n' "the layout of line 1 cannot be changed"
refused '\0357\0273\0277a: 1\n' "a byte order mark"
refused 'a: {b: 1\n' "bad.yaml:1:4: error: "
refused 'a: 1\na: 2\n' "duplicate key 'a'"
refused 'a: !x 1\n' "bad.yaml"
printf 'a: |+\n  x\n\n' >kept.yaml
printf 'a:  1\n' >changed.yaml
expect 2 check --fix kept.yaml changed.yaml
out_has changed.yaml
[ "$(cat changed.yaml)" = "a: 1" ] || fail "a file beside a refused one"

# In place: only what differs, permissions and links stay.
printf 'strut:  1\nnodes: {a: [0,0]}\n' >own.yaml
printf 'strut: 1\n' >fine.yaml
chmod 640 own.yaml
ln -s own.yaml link.yaml
touch -d '2001-01-01' fine.yaml own.yaml
cp own.yaml saved
expect 2 check --layout own.yaml fine.yaml
[ "$(cat out)" = own.yaml ] || fail "what --layout lists"
same saved own.yaml
expect 2 check --layout own.yaml -q
out_empty
expect 0 check --fix link.yaml fine.yaml
[ "$(cat out)" = link.yaml ] || fail "what was changed"
[ -h link.yaml ] || fail "a link was replaced"
[ "$(stat -c %a own.yaml)" = 640 ] || fail "other permissions"
[ "$(stat -c %Y fine.yaml)" = "$(date -d '2001-01-01' +%s)" ] || fail "a file was replaced by itself"
printf 'strut: 1\nnodes: {a: [0, 0]}\n' >wanted
same wanted own.yaml
expect 0 check --layout own.yaml fine.yaml
out_empty
expect 0 check --fix own.yaml
out_empty
expect 4 check --fix missing.yaml
err_has "No such file"
expect 1 check --fix
err_has "missing MODEL"
expect 1 check --fix own.yaml --layuot
err_has "did you mean '--layout'?"
if small_disk 64; then
  printf 'a:  1\n' >disk/a.yaml
  head -c 70000 /dev/zero >disk/full 2>/dev/null
  cp disk/a.yaml saved
  expect 4 check --fix disk/a.yaml
  same saved disk/a.yaml
  [ "$(ls disk | wc -l)" -eq 2 ] || fail "left on the disk: $(ls disk)"
  no_disk
fi

# All models and good files: the same scene, and the same layout from twice the indentation.
mkdir all
cp -R "$models" all/models
cp -R "$language/good" all/good
cp -R "$language/studies" all/studies
cp -R all/ twice
find all -name '*.yaml' | sort >files
count=0
while read -r file; do
  count=$((count + 1))
  [ $((count % 4)) -eq 0 ] || continue
  "$strut" export "$file" >"$file.before" 2>/dev/null
done <files
expect 0 check --fix --quiet $(cat files)
err_empty
expect 0 check --layout $(cat files)
while read -r file; do
  [ -e "$file.before" ] || continue
  "$strut" export "$file" >"$file.after" 2>/dev/null
  same "$file.before" "$file.after"
done <files
sed -i -E ':a; s/^(\t*)  /\1\t/; ta; s/\t/    /g' $(sed 's/^all/twice/' files)
expect 0 check --fix -q $(sed 's/^all/twice/' files)
err_empty
while read -r file; do same "$file" "twice/${file#all/}"; done <files

# Nothing makes it fall over.
mkdir bad
"$unpack" "$language/bad" bad || fail "no bad scenes"
"$strut" check --layout bad/*.yaml >out 2>err
[ $? -eq 2 ] || fail "bad files"
done_testing
