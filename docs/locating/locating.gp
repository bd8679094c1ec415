# Accuracy against computing time
# gnuplot locating.gp draws locating.svg, locating.pdf and locating.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 720,1080 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 8in,12in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1152,1728 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'locating.' . kind
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
set multiplot layout 3,1
set key outside right top vertical
set xlabel 'processor time, ms per frame of 1600 beads'
set xrange [0.796212384:188.438553]
set logscale x
set xtics ('' 0.8 1, '' 0.9 1, 1, 2, '' 3 1, '' 4 1, 5, '' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100)
set format x '%g'
set ylabel 'rms error per coordinate, px'
set yrange [0.00471177879:0.371579143]
set logscale y
set ytics (0.005, '' 0.006 1, '' 0.007 1, '' 0.008 1, '' 0.009 1, 0.01, 0.02, '' 0.03 1, '' 0.04 1, 0.05, '' 0.06 1, '' 0.07 1, '' 0.08 1, '' 0.09 1, 0.1, 0.2, '' 0.3 1)
set format y '%g'
set title '{/:Bold (a)} 15 px, SNR 51; dashed: Cramér–Rao bound'
plot 'locating.dat' index 0 using 1:2 with linespoints pt 7 ps 0.9 lw 1.8 lc rgb '#0072B2' title 'vote, then 0, 1, 2 … sweeps', 'locating.dat' index 0 using 1:3 with lines lw 1 dt 2 lc rgb '#0072B2' notitle, 'locating.dat' index 1 using 1:2 with points pt 9 ps 0.9 lw 1.8 lc rgb '#D55E00' title 'hough, alone and fitted', 'locating.dat' index 2 using 1:2 with points pt 11 ps 0.9 lw 1.8 lc rgb '#CC79A7' title 'vote, edges', 'locating.dat' index 3 using 1:2 with points pt 5 ps 0.9 lw 1.8 lc rgb '#009E73' title 'rings of 1.5 to 5 px'
set xlabel 'processor time, ms per frame of 1600 beads'
set xrange [0.796212384:188.438553]
set logscale x
set xtics ('' 0.8 1, '' 0.9 1, 1, 2, '' 3 1, '' 4 1, 5, '' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100)
set format x '%g'
set ylabel 'rms error per coordinate, px'
set yrange [0.00152400286:0.217208115]
set logscale y
set ytics (0.002, '' 0.003 1, '' 0.004 1, 0.005, '' 0.006 1, '' 0.007 1, '' 0.008 1, '' 0.009 1, 0.01, 0.02, '' 0.03 1, '' 0.04 1, 0.05, '' 0.06 1, '' 0.07 1, '' 0.08 1, '' 0.09 1, 0.1, 0.2)
set format y '%g'
set title '{/:Bold (b)} noise, 15 px'
plot 'locating.dat' index 4 using 1:2 with linespoints pt 7 ps 0.9 lw 1.8 lc rgb '#0072B2' title 'SNR 51', 'locating.dat' index 4 using 1:3 with lines lw 1 dt 2 lc rgb '#0072B2' notitle, 'locating.dat' index 5 using 1:2 with linespoints pt 9 ps 0.9 lw 1.8 lc rgb '#D55E00' title 'SNR 164', 'locating.dat' index 5 using 1:3 with lines lw 1 dt 2 lc rgb '#D55E00' notitle, 'locating.dat' index 6 using 1:2 with linespoints pt 5 ps 0.9 lw 1.8 lc rgb '#009E73' title 'SNR 18.5', 'locating.dat' index 6 using 1:3 with lines lw 1 dt 2 lc rgb '#009E73' notitle, 'locating.dat' index 7 using 1:2 with linespoints pt 11 ps 0.9 lw 1.8 lc rgb '#CC79A7' title 'SNR 8.5', 'locating.dat' index 7 using 1:3 with lines lw 1 dt 2 lc rgb '#CC79A7' notitle
set xlabel 'processor time, ms per frame of 1600 beads'
set xrange [0.796212384:188.438553]
set logscale x
set xtics autofreq
set format x '10^{%T}'
set ylabel 'rms error per coordinate, σ'
set yrange [6.07764683e-05:0.0958643895]
set logscale y
set ytics autofreq
set format y '10^{%T}'
set title '{/:Bold (c)} pixels per bead, SNR 51'
plot 'locating.dat' index 8 using 1:2 with linespoints pt 7 ps 0.9 lw 1.8 lc rgb '#0072B2' title '6 px', 'locating.dat' index 8 using 1:3 with lines lw 1 dt 2 lc rgb '#0072B2' notitle, 'locating.dat' index 9 using 1:2 with linespoints pt 9 ps 0.9 lw 1.8 lc rgb '#D55E00' title '8 px', 'locating.dat' index 9 using 1:3 with lines lw 1 dt 2 lc rgb '#D55E00' notitle, 'locating.dat' index 10 using 1:2 with linespoints pt 5 ps 0.9 lw 1.8 lc rgb '#009E73' title '10 px', 'locating.dat' index 10 using 1:3 with lines lw 1 dt 2 lc rgb '#009E73' notitle, 'locating.dat' index 11 using 1:2 with linespoints pt 11 ps 0.9 lw 1.8 lc rgb '#CC79A7' title '15 px', 'locating.dat' index 11 using 1:3 with lines lw 1 dt 2 lc rgb '#CC79A7' notitle, 'locating.dat' index 12 using 1:2 with linespoints pt 13 ps 0.9 lw 1.8 lc rgb '#E69F00' title '20 px', 'locating.dat' index 12 using 1:3 with lines lw 1 dt 2 lc rgb '#E69F00' notitle, 'locating.dat' index 13 using 1:2 with linespoints pt 6 ps 0.9 lw 1.8 lc rgb '#56B4E9' title '30 px', 'locating.dat' index 13 using 1:3 with lines lw 1 dt 2 lc rgb '#56B4E9' notitle, 'locating.dat' index 14 using 1:2 with linespoints pt 4 ps 0.9 lw 1.8 lc rgb '#000000' title '40 px', 'locating.dat' index 14 using 1:3 with lines lw 1 dt 2 lc rgb '#000000' notitle, 1./30 with lines lw 1.5 dt 4 lc rgb '#555555' title 'σ/30'
unset multiplot
unset output
reset
}
