# Granular temperature
# gnuplot p1-fig4.gp draws p1-fig4.svg, p1-fig4.pdf and p1-fig4.png
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
set output 'p1-fig4.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set multiplot layout 1,2
set logscale xy
set xrange [0.7:36]
set yrange [1e-10:10]
set format y '10^{%L}'
set xlabel 'K_m'
set ylabel 'T_g^{*}' offset 0.5,0
set lmargin 9
unset arrow
unset label
set title '(a) random, N_l = 20'
set arrow 1 from first 4.7852,graph 0 to first 4.7852,graph 1 nohead dt 2 lw 1.3 lc rgb '#666666'
set label 1 'B' at first 13.125,graph 0.06 center
set label 2 'A' at first 2.5416,graph 0.06 center
f(x) = exp(-1.1092056 + (x < 5.0769107 ? 3.7772562 : 0.57845163)*log(x/5.0769107))
plot 'p1-fig4.dat' index 0 using 1:2:3:4 with yerrorbars pt 9 ps 1 lw 1.3 lc rgb '#009E73' notitle, [1.4:*] f(x) with lines lw 1.5 lc rgb '#333333' notitle
unset arrow
unset label
set title '(b) crystal, N_l = 20'
set arrow 1 from first 7.0889,graph 0 to first 7.0889,graph 1 nohead dt 2 lw 1.3 lc rgb '#666666'
set label 1 'B' at first 15.975,graph 0.06 center
set arrow 2 from first 4.4,graph 0 to first 4.4,graph 1 nohead dt 2 lw 1.3 lc rgb '#666666'
set label 2 'A_1' at first 2.4372,graph 0.06 center
set label 3 'A_2' at first 5.5849,graph 0.06 center
plot 'p1-fig4.dat' index 1 using 1:2:3:4 with yerrorbars pt 7 ps 1 lw 1.3 lc rgb '#0072B2' notitle
unset multiplot
unset output
reset
}
