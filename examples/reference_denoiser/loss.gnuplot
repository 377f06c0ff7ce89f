# SPDX-License-Identifier: MIT
# The loss of train.py: gnuplot -e "folder='reference_denoiser'" loss.gnuplot
set terminal pngcairo size 800, 360 font "Sans,11" background "#ffffff"
set output folder . "/loss.png"
set datafile separator ","
set grid ytics lc rgb "#dddddd"
set logscale y
set ytics (0.12, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8)
set xlabel "step"
set ylabel "mean squared error of v, mean of 50 steps"
plot folder . "/loss.csv" using 1:2 skip 1 with lines lw 2 lc rgb "#cc3311" notitle
