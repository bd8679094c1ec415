# Slip probability
# gnuplot p1-fig5.gp draws p1-fig5.svg, p1-fig5.pdf and p1-fig5.png
blue = '#0072B2'
orange = '#E69F00'
vermilion = '#D55E00'
green = '#009E73'
sky = '#56B4E9'
purple = '#CC79A7'
grey = '#9A9A9A'
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 820,400 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 9.11111111111111in,4.444444444444445in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1312,640 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-fig5.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set multiplot layout 1,2
set logscale y
set xrange [0:0.75]
set yrange [3e-7:2]
set format y '10^{%L}'
set xlabel '1/K_m'
set ylabel 'p_s' offset 0.5,0
set key top right
set lmargin 9
unset arrow
unset label
set title '(a) random, N_l = 20'
set arrow from first 0.20898,graph 0 to first 0.20898,graph 1 nohead dt 2 lw 1.3 lc rgb '#666666'
set label 'B' at first 0.10499,graph 0.06 center
set label 'A' at first 0.47762,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 0 using 1:2 with points pt 9 ps 1.1 lc rgb '#009E73' notitle, 'p1-fig5.dat' index 1 using 1:2 with points pt 10 ps 1 lw 1.3 lc rgb '#009E73' title 'no slip: 95 % limit', [0.0330579:0.826446] exp(-1.144448 - 10.589866*x) with lines lw 1.6 dt 1 lc rgb '#333333' title 'E_b = 10.6'
unset arrow
unset label
set title '(b) crystal, N_l = 20'
set arrow from first 0.14107,graph 0 to first 0.14107,graph 1 nohead dt 2 lw 1.3 lc rgb '#666666'
set label 'B' at first 0.071033,graph 0.06 center
set arrow from first 0.22727,graph 0 to first 0.22727,graph 1 nohead dt 2 lw 1.3 lc rgb '#666666'
set label 'A_2' at first 0.18417,graph 0.06 center
set label 'A_1' at first 0.48677,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 2 using 1:2 with points pt 7 ps 1.1 lc rgb '#0072B2' notitle, 'p1-fig5.dat' index 3 using 1:2 with points pt 10 ps 1 lw 1.3 lc rgb '#0072B2' title 'no slip: 95 % limit', [0.141065:0.206612] exp(8.6858071 - 75.852483*x) with lines lw 1.6 dt 1 lc rgb '#333333' title 'E_b = 75.9', [0.0330579:0.141065] exp(0.35690631 - 14.427465*x) with lines lw 1.6 dt 4 lc rgb '#333333' title 'E_b = 14.4'
unset multiplot
unset output
reset
}
