# Figures 2 to 6 from FOLDER/summary.csv: gnuplot -c figures.gnuplot FOLDER
# Two readings of the feature length side by side; medians over the seeds.
folder = ARG1
data = folder . "/summary.csv"
set datafile separator ","
set key off
set grid lc rgb "#dddddd" lt 1
set border 3 lc rgb "#555555"
set tics nomirror
set xlabel "nodes"

keys = "tsai lu sapidis wei etcm default cgal constrained"
labels = "Tsai 'Lu (reconstructed)' Sapidis-Perucchio Wei 'ETCM (literal)' ours 'CGAL conforming' 'CGAL constrained'"
array colour[8] = ["#c0392b", "#8e44ad", "#e08e0b", "#16a085", "#2980b9", "#111111", "#7f8c8d", "#b8b800"]
array width[8] = [1.6, 1.6, 1.6, 1.6, 1.6, 3, 1.6, 1.6]
array symbol[8] = [5, 9, 7, 11, 13, 7, 4, 6]

# Column numbers of summary.csv by name, from its first line.
header = system("head -n 1 '" . data . "'")
column_of(name) = sum [i=1:words_of(header)] (part(header, i) eq name ? i : 0)
words_of(line) = strlen(line) - strlen(system("printf %s '" . line . "' | tr -d ,")) + 1
part(line, i) = system(sprintf("printf %%s '%s' | cut -d, -f%d", line, i))

pick(length, key, value) = (strcol(1) eq length && strcol(2) eq key) ? value : NaN
# Without a graph that ended there is nothing to show.
good(x) = column(4) > column(5) ? x : NaN

# Gains may be negative, so figure 5 has a symmetric logarithm: linear near 0, within `near`.
near = 0.003
symlog(y) = asinh(y / near)
symexp(y) = near * sinh(y)

# Figures 2 to 5: a row for each column of the table, long features on the left, short ones on the
# right. `name` is the column, `factor` scales it.
do for [figure in "2 3 4 5"] {
  number = figure + 0
  names = word("added features_us aar_edge,aar_radius aar_edge_per_point,aar_radius_per_point", number - 1)
  factor = number == 3 ? 1e-3 : number == 5 ? 1e3 : 1
  rows = number >= 4 ? 2 : 1
  last = number == 4 ? 8 : 7
  set terminal svg size 1180, rows * 460 font "Helvetica,14" background rgb "white" dynamic
  set output folder . "/figure-" . figure . ".svg"
  set logscale x
  set xrange [50:6000]
  set xtics (60, 100, 200, 400, 1000, 2000, 5000)
  if (number >= 4) { unset logscale y } else { set logscale y }
  set format y (number == 4 ? "%.2f" : "%g")
  if (number == 5) {
    set nonlinear y via symlog(y) inverse symexp(y)
    set ytics (-1, -0.1, -0.01, 0, 0.01, 0.1, 1)
  }
  set multiplot
  do for [row=1:rows] {
    name = rows == 1 ? names : system(sprintf("printf %%s '%s' | cut -d, -f%d", names, row))
    c = column_of(name)
    ratio = row == 1 ? "shortest / longest edge" : "inradius / circumradius"
    what = number == 2 ? "points added" : number == 3 ? "ms to insert the features" : \
           number == 4 ? "AAR, " . ratio : "AAR gained per 1000 points, " . ratio
    if (number == 5) {
      # Down to 0 at least, and a little beyond what there is.
      stats data skip 1 using (good(column(c)) * factor) nooutput
      set yrange [1.5 * (STATS_min < -near ? STATS_min : -near) : 1.5 * STATS_max]
    }
    set tmargin at screen 1 - (row - 1 + 0.08) / rows
    set bmargin at screen 1 - (row - 1 + 0.86) / rows
    do for [length in "long short"] {
      is_left = length eq "long"
      set lmargin at screen is_left ? 0.075 : 0.46
      set rmargin at screen is_left ? 0.405 : 0.79
      set title length . " features" offset 0,-0.5
      set ylabel (is_left ? what : "") offset 1,0
      if (is_left || row > 1) { set key off } else { set key at screen 0.985, screen 1 - 0.1 / rows right top samplen 2 spacing 1.25 }
      # The nodes' own mesh is the same in each system's lines; it has the edge ratio only.
      delaunay = number == 4 && row == 1 ? column_of("aar_edge_delaunay") : c
      plot for [i=1:last] data skip 1 using (pick(length, word(keys, i), good($3))):(column(c) * factor) \
             with linespoints lc rgb colour[i] lw width[i] pt symbol[i] ps 0.6 title word(labels, i), \
           data skip 1 using (pick(length, number == 4 && row == 1 ? "default" : "-", $3)):(column(delaunay)) \
             with lines lc rgb "#888888" lw 1.6 dt 2 title (number == 4 ? "Delaunay, no features" : "")
    }
  }
  unset multiplot
  unset output
}

# Figure 6: how straight ours is, every size with its quartiles, and the line of least squares.
reset
set datafile separator ","
set terminal svg size 1180,460 font "Helvetica,14" background rgb "white" dynamic
set grid lc rgb "#dddddd" lt 1
set border 3 lc rgb "#555555"
set tics nomirror
set key top left samplen 2 spacing 1.25
set fit quiet
set fit logfile "/dev/null"
set yrange [0:*]
set output folder . "/figure-6.svg"
set multiplot layout 1,2
ours(i, c, factor) = pick(word("long short", i), "default", column(c) * factor)
array shade[2] = ["#111111", "#2980b9"]
do for [panel=1:2] {
  yc = column_of(panel == 1 ? "features_us" : "added")
  xc = panel == 1 ? 3 : column_of("feature_count")
  factor = panel == 1 ? 1e-3 : 1
  set title panel == 1 ? "time of ours" : "points added by ours"
  set xlabel panel == 1 ? "nodes" : "features"
  set ylabel panel == 1 ? "ms to insert the features" : "points added"
  a1 = 1; b1 = 1; a2 = 1; b2 = 1
  f1(x) = a1 * x + b1
  f2(x) = a2 * x + b2
  fit f1(x) data skip 1 using (pick("long", "default", column(xc))):(pick("long", "default", column(yc) * factor)) via a1, b1
  fit f2(x) data skip 1 using (pick("short", "default", column(xc))):(pick("short", "default", column(yc) * factor)) via a2, b2
  plot for [i=1:2] data skip 1 using (ours(i, xc, 1)):(ours(i, yc, factor)):(ours(i, yc + 1, factor)):(ours(i, yc + 2, factor)) \
         with yerrorbars lc rgb shade[i] lw 1.6 pt 7 ps 0.6 title word("long short", i) . " features, quartiles over seeds", \
       f1(x) with lines lc rgb shade[1] dt 2 notitle, f2(x) with lines lc rgb shade[2] dt 2 notitle
}
unset multiplot
