# Granular temperature
# gnuplot p1-fig4.gp draws p1-fig4.svg, p1-fig4.pdf and p1-fig4.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 720,1190 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 8in,13.222222222222221in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1152,1904 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-fig4.' . kind
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
set xlabel 'K_m = A^2 ω^2/(σ g)'
set xrange [0.700802116:34.9635074]
set logscale x
set xtics autofreq
set format x '10^{%T}'
set ylabel 'T_g/(m g σ)'
set yrange [1.59216735e-10:3.07644906]
set logscale y
set ytics autofreq
set format y '10^{%T}'
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.9664
set bmargin at screen 0.7429
unset arrow
unset label
set title '{/:Bold (a)} random, N_l = 20'
set arrow from first 3.3,graph 0 to first 3.3,graph 1 nohead lw 1.5 dt 4 lc rgb '#555555'
set arrow from first 4.2539,graph 0 to first 4.2539,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 12.196,graph 0.06 center
set label 'A' at first 2.3964,graph 0.06 center
f(x) = exp(-1.1557895 + (x < 4.4827958 ? 4.3763963 : 0.70764311)*log(x/4.4827958))
plot 'p1-fig4.dat' index 0 using 1:2:3:4 with yerrorbars pt 9 lc rgb '#009E73' notitle, [1.4:*] f(x) with lines lw 1.8 lc rgb '#333333' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.9664
set bmargin at screen 0.7429
unset arrow
unset label
set title '{/:Bold (b)} crystal, N_l = 20'
set arrow from first 7.9102,graph 0 to first 7.9102,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 16.63,graph 0.06 center
set arrow from first 5.52,graph 0 to first 5.52,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'A_1' at first 2.7298,graph 0.06 center
set label 'A_2' at first 6.6079,graph 0.06 center
plot 'p1-fig4.dat' index 1 using 1:2:3:4 with yerrorbars pt 7 lc rgb '#0072B2' notitle
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.6555
set bmargin at screen 0.4319
unset arrow
unset label
set title '{/:Bold (c)} random, N_l = 40'
set arrow from first 3.3,graph 0 to first 3.3,graph 1 nohead lw 1.5 dt 4 lc rgb '#555555'
set arrow from first 2.9327,graph 0 to first 2.9327,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 10.126,graph 0.06 center
set label 'A' at first 1.9897,graph 0.06 center
f(x) = exp(-1.0183816 + (x < 5.1065519 ? 3.8608063 : 0.43940105)*log(x/5.1065519))
plot 'p1-fig4.dat' index 2 using 1:2:3:4 with yerrorbars pt 9 lc rgb '#009E73' notitle, [1.4:*] f(x) with lines lw 1.8 lc rgb '#333333' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.6555
set bmargin at screen 0.4319
unset arrow
unset label
set title '{/:Bold (d)} crystal, N_l = 40'
set arrow from first 7.2227,graph 0 to first 7.2227,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 15.891,graph 0.06 center
set arrow from first 6,graph 0 to first 6,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'A_1' at first 2.846,graph 0.06 center
set label 'A_2' at first 6.583,graph 0.06 center
plot 'p1-fig4.dat' index 3 using 1:2:3:4 with yerrorbars pt 7 lc rgb '#0072B2' notitle
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.3445
set bmargin at screen 0.1210
unset arrow
unset label
set title '{/:Bold (e)} random, N_l = 60'
set arrow from first 3.3,graph 0 to first 3.3,graph 1 nohead lw 1.5 dt 4 lc rgb '#555555'
set arrow from first 1.7227,graph 0 to first 1.7227,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 7.7608,graph 0.06 center
set label 'A' at first 1.525,graph 0.06 center
f(x) = exp(-1.2527805 + (x < 4.3499097 ? 4.0141178 : 0.59704746)*log(x/4.3499097))
plot 'p1-fig4.dat' index 4 using 1:2:3:4 with yerrorbars pt 9 lc rgb '#009E73' notitle, [1.4:*] f(x) with lines lw 1.8 lc rgb '#333333' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.3445
set bmargin at screen 0.1210
unset arrow
unset label
set title '{/:Bold (f)} crystal, N_l = 60'
set arrow from first 7.7702,graph 0 to first 7.7702,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 16.482,graph 0.06 center
set arrow from first 5.52,graph 0 to first 5.52,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'A_1' at first 2.7298,graph 0.06 center
set label 'A_2' at first 6.5491,graph 0.06 center
plot 'p1-fig4.dat' index 5 using 1:2:3:4 with yerrorbars pt 7 lc rgb '#0072B2' notitle
set lmargin at screen 0
set rmargin at screen 1
set tmargin at screen 0.0672
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
set key at screen 0.5,0.0050 center bottom horizontal
plot [0:1][0:1] NaN notitle, keyentry with points pt 9 lc rgb '#009E73' title 'random', keyentry with points pt 7 lc rgb '#0072B2' title 'crystal', \
     keyentry with lines lw 1.8 lc rgb '#333333' title 'two power laws', \
     keyentry with lines lw 1 dt 2 lc rgb '#666666' title 'border of a region', \
     keyentry with lines lw 1.5 dt 4 lc rgb '#555555' title 'paper: bend at K_m = 3.3'
unset multiplot
unset output
reset
}
