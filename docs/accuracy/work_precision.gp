# Accuracy against computing time
# gnuplot work_precision.gp draws work_precision.svg, work_precision.pdf and work_precision.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 720,760 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 8in,8.444444444444445in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1152,1216 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'work_precision.' . kind
blue = '#0072B2'
orange = '#E69F00'
vermilion = '#D55E00'
green = '#009E73'
sky = '#56B4E9'
purple = '#CC79A7'
grey = '#9A9A9A'
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set key outside below center horizontal Left reverse samplen 1.5 spacing 1.15 height 0.6
set title offset 0,-0.3
set xlabel offset 0,0.5
set pointintervalbox 0
set bars small
set palette defined (0 '#F4F1E6', 0.35 sky, 0.7 blue, 1 '#3B0F70')
set linetype 1 lc rgb '#0072B2' pt 7 ps 0.9 lw 1.3
set linetype 2 lc rgb '#D55E00' pt 9 ps 0.9 lw 1.3
set linetype 3 lc rgb '#009E73' pt 5 ps 0.9 lw 1.3
set linetype 4 lc rgb '#CC79A7' pt 13 ps 0.9 lw 1.3
set linetype 5 lc rgb '#E69F00' pt 11 ps 0.9 lw 1.3
set linetype 6 lc rgb '#56B4E9' pt 15 ps 0.9 lw 1.3
set linetype 7 lc rgb '#000000' pt 6 ps 0.9 lw 1.3
set linetype 8 lc rgb '#9A9A9A' pt 4 ps 0.9 lw 1.3
set multiplot
unset key
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.9474
set bmargin at screen 0.6053
set xlabel 'processor time, µs per bead and t_0'
set xrange [10.6149837:1697.94609]
set logscale x
set xtics autofreq
set format x '10^{%T}'
set ylabel 'error'
set yrange [6.49521743e-07:0.0672853442]
set logscale y
set ytics autofreq
set format y '10^{%T}'
set title '{/:Bold (a)} head-on: largest |e − e_{exact}|'
plot 'work_precision.dat' index 0 using 1:2 with linespoints pt 7 ps 0.4 lw 0.7 lc rgb '#0072B2' notitle, 'work_precision.dat' index 1 using 1:2 with linespoints pt 5 ps 0.4 lw 0.7 lc rgb '#E69F00' notitle, 'work_precision.dat' index 2 using 1:2 with linespoints pt 9 ps 0.4 lw 0.7 lc rgb '#D55E00' notitle, 'work_precision.dat' index 3 using 1:2 with linespoints pt 7 ps 0.9 lw 1.8 lc rgb '#0072B2' notitle, 'work_precision.dat' index 4 using 1:2 with linespoints pt 5 ps 0.9 lw 1.8 lc rgb '#E69F00' notitle, 'work_precision.dat' index 5 using 1:2 with linespoints pt 9 ps 0.9 lw 1.8 lc rgb '#D55E00' notitle, 'work_precision.dat' index 6 using 1:2 with linespoints pt 7 ps 0.4 lw 0.7 lc rgb '#0072B2' notitle, 'work_precision.dat' index 7 using 1:2 with linespoints pt 5 ps 0.4 lw 0.7 lc rgb '#E69F00' notitle, 'work_precision.dat' index 8 using 1:2 with linespoints pt 9 ps 0.4 lw 0.7 lc rgb '#D55E00' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.9474
set bmargin at screen 0.6053
set xlabel 'processor time, µs per bead and t_0'
set xrange [10.6149837:1697.94609]
set logscale x
set xtics autofreq
set format x '10^{%T}'
set ylabel 'error'
set yrange [4.54205206e-07:0.139772746]
set logscale y
set ytics autofreq
set format y '10^{%T}'
set title '{/:Bold (b)} oblique, no slip: largest, v_t^′/v_t'
plot 'work_precision.dat' index 0 using 1:3 with linespoints pt 7 ps 0.4 lw 0.7 lc rgb '#0072B2' notitle, 'work_precision.dat' index 1 using 1:3 with linespoints pt 5 ps 0.4 lw 0.7 lc rgb '#E69F00' notitle, 'work_precision.dat' index 2 using 1:3 with linespoints pt 9 ps 0.4 lw 0.7 lc rgb '#D55E00' notitle, 'work_precision.dat' index 3 using 1:3 with linespoints pt 7 ps 0.9 lw 1.8 lc rgb '#0072B2' notitle, 'work_precision.dat' index 4 using 1:3 with linespoints pt 5 ps 0.9 lw 1.8 lc rgb '#E69F00' notitle, 'work_precision.dat' index 5 using 1:3 with linespoints pt 9 ps 0.9 lw 1.8 lc rgb '#D55E00' notitle, 'work_precision.dat' index 6 using 1:3 with linespoints pt 7 ps 0.4 lw 0.7 lc rgb '#0072B2' notitle, 'work_precision.dat' index 7 using 1:3 with linespoints pt 5 ps 0.4 lw 0.7 lc rgb '#E69F00' notitle, 'work_precision.dat' index 8 using 1:3 with linespoints pt 9 ps 0.4 lw 0.7 lc rgb '#D55E00' notitle
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.4684
set bmargin at screen 0.1263
set xlabel 'processor time, µs per bead and t_0'
set xrange [10.6149837:1697.94609]
set logscale x
set xtics autofreq
set format x '10^{%T}'
set ylabel 'error'
set yrange [8.53741289e-07:0.0807235762]
set logscale y
set ytics autofreq
set format y '10^{%T}'
set title '{/:Bold (c)} impacts of a bed: rms, Rω^′/v'
plot 'work_precision.dat' index 0 using 1:4 with linespoints pt 7 ps 0.4 lw 0.7 lc rgb '#0072B2' notitle, 'work_precision.dat' index 1 using 1:4 with linespoints pt 5 ps 0.4 lw 0.7 lc rgb '#E69F00' notitle, 'work_precision.dat' index 2 using 1:4 with linespoints pt 9 ps 0.4 lw 0.7 lc rgb '#D55E00' notitle, 'work_precision.dat' index 3 using 1:4 with linespoints pt 7 ps 0.9 lw 1.8 lc rgb '#0072B2' notitle, 'work_precision.dat' index 4 using 1:4 with linespoints pt 5 ps 0.9 lw 1.8 lc rgb '#E69F00' notitle, 'work_precision.dat' index 5 using 1:4 with linespoints pt 9 ps 0.9 lw 1.8 lc rgb '#D55E00' notitle, 'work_precision.dat' index 6 using 1:4 with linespoints pt 7 ps 0.4 lw 0.7 lc rgb '#0072B2' notitle, 'work_precision.dat' index 7 using 1:4 with linespoints pt 5 ps 0.4 lw 0.7 lc rgb '#E69F00' notitle, 'work_precision.dat' index 8 using 1:4 with linespoints pt 9 ps 0.4 lw 0.7 lc rgb '#D55E00' notitle
set lmargin at screen 0
set rmargin at screen 1
set tmargin at screen 0.0421
set bmargin at screen 0
unset title
unset xlabel
unset ylabel
unset arrow
unset label
unset object
unset border
unset tics
unset grid
unset logscale
unset xzeroaxis
set key at screen 0.5,0.0079 center bottom horizontal
plot [0:1][0:1] NaN notitle, keyentry with linespoints pt 7 ps 0.9 lc rgb '#0072B2' title 'verlet', \
     keyentry with linespoints pt 5 ps 0.9 lc rgb '#E69F00' title 'predicted', \
     keyentry with linespoints pt 9 ps 0.9 lc rgb '#D55E00' title 'split'
unset multiplot
unset output
reset
}
