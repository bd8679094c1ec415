# What accuracy costs in time
# gnuplot locating.gp draws locating.svg, locating.pdf and locating.png
blue = '#0072B2'
orange = '#E69F00'
vermilion = '#D55E00'
green = '#009E73'
sky = '#56B4E9'
purple = '#CC79A7'
grey = '#9A9A9A'
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 1260,440 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 14in,4.888888888888889in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 2016,704 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'locating.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set multiplot layout 1,3
set logscale xy
set format y '10^{%T}'
set key top right
set yrange [1e-3:5]
set xlabel 'processor time, ms a frame of 1600 beads'
set ylabel 'rms error per coordinate, px'
set title '15 px, SNR 51; dashed: Cramér–Rao bound'
plot 'locating.dat' index 0 using 1:2 with linespoints pt 7 ps 0.9 lw 2 lc rgb '#0072B2' title 'vote, then 0, 1, 2 … sweeps', 'locating.dat' index 0 using 1:3 with lines lw 1 dt 2 lc rgb '#0072B2' notitle, 'locating.dat' index 1 using 1:2 with points pt 9 ps 0.9 lw 2 lc rgb '#D55E00' title 'hough, alone and fitted', 'locating.dat' index 2 using 1:2 with points pt 11 ps 0.9 lw 2 lc rgb '#CC79A7' title 'vote, edges', 'locating.dat' index 3 using 1:2 with points pt 5 ps 0.9 lw 2 lc rgb '#009E73' title 'rings of 1.5 to 5 px'
set title 'noise, 15 px'
plot 'locating.dat' index 4 using 1:2 with linespoints pt 7 ps 0.9 lw 2 lc rgb '#0072B2' title 'SNR 51', 'locating.dat' index 4 using 1:3 with lines lw 1 dt 2 lc rgb '#0072B2' notitle, 'locating.dat' index 5 using 1:2 with linespoints pt 9 ps 0.9 lw 2 lc rgb '#D55E00' title 'SNR 164', 'locating.dat' index 5 using 1:3 with lines lw 1 dt 2 lc rgb '#D55E00' notitle, 'locating.dat' index 6 using 1:2 with linespoints pt 5 ps 0.9 lw 2 lc rgb '#009E73' title 'SNR 18.5', 'locating.dat' index 6 using 1:3 with lines lw 1 dt 2 lc rgb '#009E73' notitle, 'locating.dat' index 7 using 1:2 with linespoints pt 11 ps 0.9 lw 2 lc rgb '#CC79A7' title 'SNR 8.5', 'locating.dat' index 7 using 1:3 with lines lw 1 dt 2 lc rgb '#CC79A7' notitle
set title 'pixels per bead, SNR 51'
set yrange [*:*]
set key outside right
set ylabel 'rms error per coordinate, σ'
plot 'locating.dat' index 8 using 1:2 with linespoints pt 7 ps 0.9 lw 2 lc rgb '#0072B2' title '6 px', 'locating.dat' index 8 using 1:3 with lines lw 1 dt 2 lc rgb '#0072B2' notitle, 'locating.dat' index 9 using 1:2 with linespoints pt 9 ps 0.9 lw 2 lc rgb '#D55E00' title '8 px', 'locating.dat' index 9 using 1:3 with lines lw 1 dt 2 lc rgb '#D55E00' notitle, 'locating.dat' index 10 using 1:2 with linespoints pt 5 ps 0.9 lw 2 lc rgb '#009E73' title '10 px', 'locating.dat' index 10 using 1:3 with lines lw 1 dt 2 lc rgb '#009E73' notitle, 'locating.dat' index 11 using 1:2 with linespoints pt 11 ps 0.9 lw 2 lc rgb '#CC79A7' title '15 px', 'locating.dat' index 11 using 1:3 with lines lw 1 dt 2 lc rgb '#CC79A7' notitle, 'locating.dat' index 12 using 1:2 with linespoints pt 13 ps 0.9 lw 2 lc rgb '#E69F00' title '20 px', 'locating.dat' index 12 using 1:3 with lines lw 1 dt 2 lc rgb '#E69F00' notitle, 'locating.dat' index 13 using 1:2 with linespoints pt 6 ps 0.9 lw 2 lc rgb '#56B4E9' title '30 px', 'locating.dat' index 13 using 1:3 with lines lw 1 dt 2 lc rgb '#56B4E9' notitle, 'locating.dat' index 14 using 1:2 with linespoints pt 4 ps 0.9 lw 2 lc rgb '#000000' title '40 px', 'locating.dat' index 14 using 1:3 with lines lw 1 dt 2 lc rgb '#000000' notitle, 1./30 with lines lc rgb grey title 'σ/30'
unset multiplot
unset output
reset
}
