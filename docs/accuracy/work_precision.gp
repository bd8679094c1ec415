# What accuracy costs in time
# gnuplot work_precision.gp draws work_precision.svg, work_precision.pdf and work_precision.png
blue = '#0072B2'
orange = '#E69F00'
vermilion = '#D55E00'
green = '#009E73'
sky = '#56B4E9'
purple = '#CC79A7'
grey = '#9A9A9A'
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 1380,460 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 15.333333333333334in,5.111111111111111in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 2208,736 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'work_precision.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set multiplot layout 1,3
set logscale xy
set format y '10^{%T}'
set key bottom left
set xlabel 'processor time, µs a bead and t_0'
set title 'head-on: largest |e − e_{exact}|'
plot 'work_precision.dat' index 0 using 1:2 with linespoints pt 7 ps 0.4 lw 0.7 lc rgb '#0072B2' notitle, 'work_precision.dat' index 1 using 1:2 with linespoints pt 5 ps 0.4 lw 0.7 lc rgb '#E69F00' notitle, 'work_precision.dat' index 2 using 1:2 with linespoints pt 9 ps 0.4 lw 0.7 lc rgb '#D55E00' notitle, 'work_precision.dat' index 3 using 1:2 with linespoints pt 7 ps 0.9 lw 2 lc rgb '#0072B2' title 'verlet', 'work_precision.dat' index 4 using 1:2 with linespoints pt 5 ps 0.9 lw 2 lc rgb '#E69F00' title 'predicted', 'work_precision.dat' index 5 using 1:2 with linespoints pt 9 ps 0.9 lw 2 lc rgb '#D55E00' title 'split', 'work_precision.dat' index 6 using 1:2 with linespoints pt 7 ps 0.4 lw 0.7 lc rgb '#0072B2' notitle, 'work_precision.dat' index 7 using 1:2 with linespoints pt 5 ps 0.4 lw 0.7 lc rgb '#E69F00' notitle, 'work_precision.dat' index 8 using 1:2 with linespoints pt 9 ps 0.4 lw 0.7 lc rgb '#D55E00' notitle
set title 'oblique, no slip: largest error of v_t^′/v_t'
unset key
plot 'work_precision.dat' index 0 using 1:3 with linespoints pt 7 ps 0.4 lw 0.7 lc rgb '#0072B2' notitle, 'work_precision.dat' index 1 using 1:3 with linespoints pt 5 ps 0.4 lw 0.7 lc rgb '#E69F00' notitle, 'work_precision.dat' index 2 using 1:3 with linespoints pt 9 ps 0.4 lw 0.7 lc rgb '#D55E00' notitle, 'work_precision.dat' index 3 using 1:3 with linespoints pt 7 ps 0.9 lw 2 lc rgb '#0072B2' title 'verlet', 'work_precision.dat' index 4 using 1:3 with linespoints pt 5 ps 0.9 lw 2 lc rgb '#E69F00' title 'predicted', 'work_precision.dat' index 5 using 1:3 with linespoints pt 9 ps 0.9 lw 2 lc rgb '#D55E00' title 'split', 'work_precision.dat' index 6 using 1:3 with linespoints pt 7 ps 0.4 lw 0.7 lc rgb '#0072B2' notitle, 'work_precision.dat' index 7 using 1:3 with linespoints pt 5 ps 0.4 lw 0.7 lc rgb '#E69F00' notitle, 'work_precision.dat' index 8 using 1:3 with linespoints pt 9 ps 0.4 lw 0.7 lc rgb '#D55E00' notitle
set title 'impacts of a bed: rms error of Rω^′/v'
plot 'work_precision.dat' index 0 using 1:4 with linespoints pt 7 ps 0.4 lw 0.7 lc rgb '#0072B2' notitle, 'work_precision.dat' index 1 using 1:4 with linespoints pt 5 ps 0.4 lw 0.7 lc rgb '#E69F00' notitle, 'work_precision.dat' index 2 using 1:4 with linespoints pt 9 ps 0.4 lw 0.7 lc rgb '#D55E00' notitle, 'work_precision.dat' index 3 using 1:4 with linespoints pt 7 ps 0.9 lw 2 lc rgb '#0072B2' title 'verlet', 'work_precision.dat' index 4 using 1:4 with linespoints pt 5 ps 0.9 lw 2 lc rgb '#E69F00' title 'predicted', 'work_precision.dat' index 5 using 1:4 with linespoints pt 9 ps 0.9 lw 2 lc rgb '#D55E00' title 'split', 'work_precision.dat' index 6 using 1:4 with linespoints pt 7 ps 0.4 lw 0.7 lc rgb '#0072B2' notitle, 'work_precision.dat' index 7 using 1:4 with linespoints pt 5 ps 0.4 lw 0.7 lc rgb '#E69F00' notitle, 'work_precision.dat' index 8 using 1:4 with linespoints pt 9 ps 0.4 lw 0.7 lc rgb '#D55E00' notitle
unset multiplot
unset output
reset
}
