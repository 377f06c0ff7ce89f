# SPDX-License-Identifier: MIT
# Frame consistency against the interval: measured on the left, the paper's table 2 on the right.
#   gnuplot -e "folder='build/evaluation'" examples/evaluation/consistency.gnuplot
set terminal pngcairo size 1200, 480 font "Sans,11" background "#ffffff"
set output folder . "/consistency.png"
set datafile separator ","
set key bottom left
set grid ytics lc rgb "#dddddd"
set xlabel "frames between the two images"
set xtics (1, 5, 10, 15, 20)
set xrange [0:21]
data = folder . "/consistency.csv"
methods = "Per-Frame Pix2Video* TokenFlow* paper vivid Gen1"
array colours[6] = ["#888888", "#4477aa", "#228833", "#ee8866", "#cc3311", "#ccbb44"]
set multiplot layout 1, 2
set title "measured here (embedder of the miniature; mean and standard error)"
set ylabel "frame consistency"
# Gen1 is proprietary: its figures are quoted, not measured.
# A single run has no standard error.
plot for [i = 1:5] data using 2:(strcol(1) eq word(methods, i) ? $3 : NaN) skip 1 \
    with linespoints lw 2 pt 7 lc rgb colours[i] title word(methods, i), \
    for [i = 1:5] data using 2:(strcol(1) eq word(methods, i) ? $3 : NaN):4 skip 1 \
    with yerrorbars lw 2 pt 7 lc rgb colours[i] notitle
set title "the paper (CLIP)"
plot for [i in "1 2 3 4 6"] data using 2:(strcol(1) eq word(methods, int(i)) ? $5 : NaN) skip 1 \
    with linespoints lw 2 pt 7 lc rgb colours[int(i)] title word(methods, int(i))
unset multiplot
