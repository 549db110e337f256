# SPDX-License-Identifier: GPL-3.0-or-later
# scene.yaml, then nodes.csv of the same run -> one SVG on standard output. See picture.sh.
function px(x) { return sprintf("%.2f", 40 + (x - left) * scale) }
function py(y) { return sprintf("%.2f", 190 - y * scale) }
function line(a, b, style) {
  printf "<line x1=\"%s\" y1=\"%s\" x2=\"%s\" y2=\"%s\" %s/>\n", px(X[a]), py(Y[a]), px(X[b]), py(Y[b]), style
}
function structure(opacity,   i) {
  printf "<g opacity=\"%s\" stroke-linecap=\"round\">\n", opacity
  for (i = 1; i <= members; i++)
    line(from[i], to[i], kind[i] == "bar" ? "stroke=\"#222\" stroke-width=\"5\"" : "stroke=\"#1f6fb2\" stroke-width=\"1.6\"")
  for (i = 1; i <= nodes; i++)
    printf "<circle cx=\"%s\" cy=\"%s\" r=\"3.4\" fill=\"white\" stroke=\"#222\" stroke-width=\"1.4\"/>\n", px(X[name[i]]), py(Y[name[i]])
  print "</g>"
}
FNR == NR { # a member: "  m1: {nodes: [n1, n2], kind: bar, ..."
  if (match($0, /\{nodes: \[[^]]*\], kind: [a-z]+/)) {
    text = substr($0, RSTART, RLENGTH)
    split(text, part, /[][,:{} ]+/)
    members++
    from[members] = part[3]; to[members] = part[4]; kind[members] = part[6]
  }
  next
}
FNR == 1 {
  columns = split($0, head, ",")
  for (c = 2; c <= columns; c += 2) { name[++nodes] = head[c]; sub(/\.x.*/, "", name[nodes]) }
  next
}
{
  split($0, value, ",")
  for (i = 1; i <= nodes; i++) { X[name[i]] = value[2 * i]; Y[name[i]] = value[2 * i + 1] }
  if (FNR == 2) {
    scale = 5600
    left = X["n1"]
    print "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 720 230\" font-family=\"sans-serif\" font-size=\"13\">"
    print "<rect width=\"720\" height=\"230\" fill=\"white\"/>"
    print "<line x1=\"10\" y1=\"190\" x2=\"710\" y2=\"190\" stroke=\"#888\" stroke-width=\"1.5\"/>"
    t0 = value[1]
    structure(0.3)
  }
  for (i = 1; i <= nodes; i++) path[i] = path[i] (FNR == 2 ? "M" : "L") px(X[name[i]]) " " py(Y[name[i]])
  t1 = value[1]
}
END {
  for (i = 1; i <= nodes; i++) printf "<path d=\"%s\" fill=\"none\" stroke=\"#d1495b\" stroke-width=\"1\"/>\n", path[i]
  structure(1)
  for (i = 1; i <= nodes; i++) printf "<text x=\"%s\" y=\"%s\">%s</text>\n", px(X[name[i]]) + 7, py(Y[name[i]]) - 7, name[i]
  printf "<text x=\"40\" y=\"217\">ten drive periods (%g s) at 10 Hz, friction 0.1; pale: where they began; red: the way of each node</text>\n", t1 - t0
  print "</svg>"
}
