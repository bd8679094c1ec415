# Slip probability
# gnuplot p1-fig5.gp draws p1-fig5.svg, p1-fig5.pdf and p1-fig5.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 720,1170 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 8in,13in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1152,1872 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-fig5.' . kind
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
set tmargin at screen 0.9658
set bmargin at screen 0.7373
set xlabel '1/K_m'
set xrange [-0.0330578512:0.859504132]
unset logscale x
set xtics 0.2
set format x '%g'
set ylabel 'p_s'
set yrange [2.92166925e-07:5.58205299]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (a)} random, N_l = 20'
set arrow from first 0.23508,graph 0 to first 0.23508,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.11804,graph 0.06 center
set label 'E_b = 12.5 (paper 7)' at graph 0.97,0.930 right
set label 'A' at first 0.49067,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 0 using 1:2:3:4 with yerrorbars pt 9 lc rgb '#009E73' notitle, [0.0330579:0.826446] exp(-0.77596133 - 12.46085*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:0.826446] exp(-2.4383167 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.9658
set bmargin at screen 0.7373
set xlabel '1/K_m'
set xrange [-0.0277777778:0.722222222]
unset logscale x
set xtics 0.1
set format x '%g'
set ylabel 'p_s'
set yrange [2.92166925e-07:5.58205299]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (b)} crystal, N_l = 20'
set arrow from first 0.12642,graph 0 to first 0.12642,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.06371,graph 0.06 center
set label 'A_2: E_b = 74.4 (paper 130)' at graph 0.97,0.930 right
set label 'B: E_b = 12.4 (paper 7)' at graph 0.97,0.840 right
set arrow from first 0.27778,graph 0 to first 0.27778,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'A_2' at first 0.2021,graph 0.06 center
set label 'A_1' at first 0.51202,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 2 using 1:2:3:4 with yerrorbars pt 7 lc rgb '#0072B2' notitle, 'p1-fig5.dat' index 3 using 1:2 with points pt 10 lc rgb '#0072B2' notitle, [0.12642:0.25] exp(8.8908201 - 74.353281*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.12642:0.25] exp(18.572743 - 130*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle, [0.0330579:0.12642] exp(0.22557553 - 12.442946*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:0.12642] exp(-0.17873101 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.6484
set bmargin at screen 0.4199
set xlabel '1/K_m'
set xrange [-0.04:1.04]
unset logscale x
set xtics 0.2
set format x '%g'
set ylabel 'p_s'
set yrange [2.92166925e-07:5.58205299]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (c)} random, N_l = 40'
set arrow from first 0.34099,graph 0 to first 0.34099,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.17099,graph 0.06 center
set label 'E_b = 11.5 (paper 7)' at graph 0.97,0.930 right
set label 'A' at first 0.54363,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 4 using 1:2:3:4 with yerrorbars pt 9 lc rgb '#009E73' notitle, [0.0330579:1] exp(-0.25994349 - 11.510722*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:1] exp(-1.7982041 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.6484
set bmargin at screen 0.4199
set xlabel '1/K_m'
set xrange [-0.0204081633:0.530612245]
unset logscale x
set xtics 0.1
set format x '%g'
set ylabel 'p_s'
set yrange [2.92166925e-07:5.58205299]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (d)} crystal, N_l = 40'
set arrow from first 0.13845,graph 0 to first 0.13845,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.069727,graph 0.06 center
set label 'A_2: E_b = 157 (paper 130)' at graph 0.97,0.930 right
set label 'B: E_b = 12.7 (paper 7)' at graph 0.97,0.840 right
set arrow from first 0.22727,graph 0 to first 0.22727,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'A_2' at first 0.18286,graph 0.06 center
set label 'A_1' at first 0.48677,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 6 using 1:2:3:4 with yerrorbars pt 7 lc rgb '#0072B2' notitle, 'p1-fig5.dat' index 7 using 1:2 with points pt 10 lc rgb '#0072B2' notitle, [0.138453:0.206612] exp(20.200375 - 157.33827*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.138453:0.206612] exp(15.404217 - 130*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle, [0.0330579:0.138453] exp(0.1168928 - 12.653374*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:0.138453] exp(-0.36871617 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.3311
set bmargin at screen 0.1026
set xlabel '1/K_m'
set xrange [-0.04:1.04]
unset logscale x
set xtics 0.2
set format x '%g'
set ylabel 'p_s'
set yrange [2.92166925e-07:5.58205299]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (e)} random, N_l = 60'
set arrow from first 0.5805,graph 0 to first 0.5805,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.29075,graph 0.06 center
set label 'E_b = 11.2 (paper 7)' at graph 0.97,0.930 right
set label 'A' at first 0.66338,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 8 using 1:2:3:4 with yerrorbars pt 9 lc rgb '#009E73' notitle, [0.0330579:1] exp(0.0055764542 - 11.2425*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:1] exp(-1.4412139 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.3311
set bmargin at screen 0.1026
set xlabel '1/K_m'
set xrange [-0.0204081633:0.530612245]
unset logscale x
set xtics 0.1
set format x '%g'
set ylabel 'p_s'
set yrange [2.92166925e-07:5.58205299]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (f)} crystal, N_l = 60'
set arrow from first 0.1287,graph 0 to first 0.1287,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.064849,graph 0.06 center
set label 'A_2: E_b = 138 (paper 130)' at graph 0.97,0.930 right
set label 'B: E_b = 8.55 (paper 7)' at graph 0.97,0.840 right
set arrow from first 0.18116,graph 0 to first 0.18116,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'A_2' at first 0.15493,graph 0.06 center
set label 'A_1' at first 0.46371,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 10 using 1:2:3:4 with yerrorbars pt 7 lc rgb '#0072B2' notitle, 'p1-fig5.dat' index 11 using 1:2 with points pt 10 lc rgb '#0072B2' notitle, [0.128698:0.173611] exp(15.285547 - 137.57446*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.128698:0.173611] exp(14.11394 - 130*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle, [0.0330579:0.128698] exp(-0.21179752 - 8.5535999*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:0.128698] exp(-0.33639583 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0
set rmargin at screen 1
set tmargin at screen 0.0479
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
set key at screen 0.5,0.0051 center bottom horizontal
plot [0:1][0:1] NaN notitle, keyentry with points pt 9 lc rgb '#009E73' title 'random', keyentry with points pt 7 lc rgb '#0072B2' title 'crystal', \
     keyentry with points pt 10 lc rgb '#333333' title 'no slip: limit', \
     keyentry with lines lw 1.8 lc rgb '#333333' title 'Arrhenius law', \
     keyentry with lines lw 1 dt 2 lc rgb '#666666' title 'border of a region', \
     keyentry with lines lw 1.5 dt 4 lc rgb '#555555' title 'paper’s E_b'
unset multiplot
unset output
reset
}
