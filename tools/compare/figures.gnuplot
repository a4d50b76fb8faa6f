# Figures 2 to 6 from FOLDER/summary.csv: gnuplot -c figures.gnuplot FOLDER
# Two readings of the feature length side by side; medians over the seeds.
folder = ARG1
data = folder . "/summary.csv"
set datafile separator ","
set terminal svg size 1180,500 font "Helvetica,14" background rgb "white" dynamic
set key off
set grid lc rgb "#dddddd" lt 1
set border 3 lc rgb "#555555"
set tics nomirror
set xlabel "nodes"
set lmargin 10
set rmargin 2

keys = "tsai lu sapidis wei etcm default cgal constrained"
labels = "Tsai 'Lu (reconstructed)' Sapidis-Perucchio Wei 'ETCM (paper)' ours 'CGAL conforming' 'CGAL constrained'"
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
good() = column(4) > column(5)

# One figure: `name` is the column, `factor` scales it.
do for [figure in "2 3 4 5"] {
  number = int(figure)
  name = word("added features_us aar_edge aar_edge_per_point", number - 1)
  factor = real(word("1 1e-3 1 1e3", number - 1))
  what = number == 2 ? "points added" : number == 3 ? "ms to insert the features" : \
         number == 4 ? "AAR (shortest / longest edge)" : "AAR gained per 1000 points"
  last = number == 4 ? 8 : 7
  c = column_of(name)
  delaunay = column_of("aar_edge_delaunay")
  set output folder . "/figure-" . figure . ".svg"
  if (number == 4) { unset logscale y; set format y "%.3f" } else { set logscale y; set format y "%g" }
  if (number == 5) { set logscale x } else { unset logscale x }
  set multiplot layout 1,2
  do for [length in "long short"] {
    set title length . " features" offset 0,-0.5
    set ylabel (length eq "long" ? what : "")
    if (length eq "short") { set key outside right center samplen 2 spacing 1.2 } else { set key off }
    if (length eq "short") { set size 0.58,1; set origin 0.42,0 } else { set size 0.42,1; set origin 0,0 }
    if (number == 4) {
      plot for [i=1:8] data skip 1 using (pick(length, word(keys, i), good() ? $3 : NaN)):(column(c) * factor) \
             with linespoints lc rgb colour[i] lw width[i] pt symbol[i] ps 0.6 title word(labels, i), \
           data skip 1 using (pick(length, "default", $3)):(column(delaunay)) \
             with lines lc rgb "#888888" lw 1.6 dt 2 title "Delaunay, no features"
    } else {
      plot for [i=1:7] data skip 1 using (pick(length, word(keys, i), good() ? $3 : NaN)):(column(c) * factor) \
             with linespoints lc rgb colour[i] lw width[i] pt symbol[i] ps 0.6 title word(labels, i)
    }
  }
  unset multiplot
  unset output
}

# Figure 6: how straight ours is, every size with its quartiles, and the line of least squares.
unset logscale
set format y "%g"
set format x "%g"
set output folder . "/figure-6.svg"
set multiplot layout 1,2
set size 0.5,1
set key top left samplen 2 spacing 1.2
set fit quiet
set fit logfile "/dev/null"
array base[2] = ["#111111", "#2980b9"]
do for [panel=1:2] {
  c = column_of(panel == 1 ? "features_us" : "added")
  factor = panel == 1 ? 1e-3 : 1
  x = panel == 1 ? 3 : column_of("feature_count")
  set origin (panel - 1) * 0.5, 0
  set title panel == 1 ? "time of ours" : "points added by ours"
  set xlabel panel == 1 ? "nodes" : "features"
  set ylabel panel == 1 ? "ms to insert the features" : "points added"
  a1 = 1; b1 = 0; a2 = 1; b2 = 0
  f1(t) = a1 * t + b1
  f2(t) = a2 * t + b2
  fit f1(x) data skip 1 using (pick("long", "default", column(x))):(column(c) * factor) via a1, b1
  fit f2(x) data skip 1 using (pick("short", "default", column(x))):(column(c) * factor) via a2, b2
  plot for [i=1:2] data skip 1 using (pick(word("long short", i), "default", column(x))):(column(c) * factor):(column(c + 1) * factor):(column(c + 2) * factor) \
         with yerrorbars lc rgb base[i] lw 1.6 pt 7 ps 0.6 title word("long short", i) . " features, quartiles over seeds", \
       f1(x) with lines lc rgb base[1] dt 2 notitle, f2(x) with lines lc rgb base[2] dt 2 notitle
}
unset multiplot
