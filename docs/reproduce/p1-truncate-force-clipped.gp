# Slip probability
# gnuplot p1-truncate-force-clipped.gp draws p1-truncate-force-clipped.svg, p1-truncate-force-clipped.pdf and p1-truncate-force-clipped.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 720,430 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 8in,4.777777777777778in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1152,688 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-truncate-force-clipped.' . kind
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
set tmargin at screen 0.9070
set bmargin at screen 0.2791
set xlabel '1/K_m'
set xrange [-0.04:1.04]
unset logscale x
set xtics 0.2
set format x '%g'
set ylabel 'p_s'
set yrange [1.11248105e-06:5.30225753]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (a)} random, N_l = 20'
set arrow from first 0.25315,graph 0 to first 0.25315,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.12708,graph 0.06 center
set label 'E_b = 11.4' at graph 0.97,0.930 right
set label '(paper 7)' at graph 0.97,0.850 right
set label 'A' at first 0.49971,graph 0.06 center
plot NaN notitle, 'p1-truncate-force-clipped.dat' index 0 using 1:2:3:4 with yerrorbars pt 9 lc rgb '#009E73' notitle, [0.0330579:1] exp(-0.4063551 - 11.371837*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:1] exp(-1.8972526 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.9070
set bmargin at screen 0.2791
set xlabel '1/K_m'
set xrange [-0.0204081633:0.530612245]
unset logscale x
set xtics 0.1
set format x '%g'
set ylabel 'p_s'
set yrange [1.11248105e-06:5.30225753]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (b)} crystal, N_l = 20'
set arrow from first 0.22948,graph 0 to first 0.22948,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.11524,graph 0.06 center
set label 'B: E_b = 12.9' at graph 0.97,0.710 right
set label '(paper 7)' at graph 0.97,0.630 right
set arrow from first 0.27778,graph 0 to first 0.27778,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'A_2' at first 0.25363,graph 0.06 center
set label 'A_1' at first 0.44753,graph 0.06 center
plot NaN notitle, 'p1-truncate-force-clipped.dat' index 2 using 1:2:3:4 with yerrorbars pt 7 lc rgb '#0072B2' notitle, 'p1-truncate-force-clipped.dat' index 3 using 1:2 with points pt 10 lc rgb '#0072B2' notitle, [0.0330579:0.229481] exp(0.47639284 - 12.864019*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:0.229481] exp(-0.20233192 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0
set rmargin at screen 1
set tmargin at screen 0.1302
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
set key at screen 0.5,0.0140 center bottom horizontal
plot [0:1][0:1] NaN notitle, keyentry with points pt 9 lc rgb '#009E73' title 'random', keyentry with points pt 7 lc rgb '#0072B2' title 'crystal', \
     keyentry with points pt 10 lc rgb '#333333' title 'no slip: limit', \
     keyentry with lines lw 1.8 lc rgb '#333333' title 'Arrhenius law', \
     keyentry with lines lw 1 dt 2 lc rgb '#666666' title 'border of a region', \
     keyentry with lines lw 1.5 dt 4 lc rgb '#555555' title 'paper’s E_b'
unset multiplot
unset output
reset
}
