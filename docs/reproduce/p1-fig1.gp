# Beds before the drive, N_l = 60
# gnuplot p1-fig1.gp draws p1-fig1.pdf and p1-fig1.png
do for [kind in 'pdf png'] {
if (kind eq 'pdf') {
  set terminal pdfcairo size 6in,5.955555555555556in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 864,857 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-fig1.' . kind
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
set size ratio -1
set xrange [-0.3:20.3]
set yrange [-0.6:57.343452108868405]
unset tics
unset grid
unset border
unset key
set lmargin at screen 0.022222222222222223
set rmargin at screen 0.32592592592592595
set tmargin at screen 0.9440298507462687
set bmargin at screen 0.08340039977408908
set title '(a) crystal A' noenhanced offset 0,-0.6
set arrow 1 from 0,0 to 0,57.343452108868405 nohead front lw 2 lc rgb '#222222'
set arrow 2 from 20,0 to 20,57.343452108868405 nohead front lw 2 lc rgb '#222222'
set arrow 3 from 0,0 to 20,0 nohead front lw 2 lc rgb '#222222'
plot 'p1-fig1.dat' index 0 using 1:2:3:4 with circles fs solid border lc rgb '#333333' lw 0.5 fc rgb variable notitle
set lmargin at screen 0.34814814814814815
set rmargin at screen 0.6518518518518519
set tmargin at screen 0.9440298507462687
set bmargin at screen 0.08340039977408908
set title '(b) random' noenhanced offset 0,-0.6
set arrow 1 from 0,0 to 0,57.343452108868405 nohead front lw 2 lc rgb '#222222'
set arrow 2 from 20,0 to 20,57.343452108868405 nohead front lw 2 lc rgb '#222222'
set arrow 3 from 0,0 to 20,0 nohead front lw 2 lc rgb '#222222'
plot 'p1-fig1.dat' index 1 using 1:2:3:4 with circles fs solid border lc rgb '#333333' lw 0.5 fc rgb variable notitle
set lmargin at screen 0.674074074074074
set rmargin at screen 0.9777777777777777
set tmargin at screen 0.9440298507462687
set bmargin at screen 0.08340039977408908
set title '(c) another seed' noenhanced offset 0,-0.6
set arrow 1 from 0,0 to 0,57.343452108868405 nohead front lw 2 lc rgb '#222222'
set arrow 2 from 20,0 to 20,57.343452108868405 nohead front lw 2 lc rgb '#222222'
set arrow 3 from 0,0 to 20,0 nohead front lw 2 lc rgb '#222222'
set label 1 'hexagonal' at screen 0.04,0.03731343283582089 point pt 7 ps 1.8 lc rgb '#009E73' offset 1.2,0
set label 2 'square' at screen 0.27499999999999997,0.03731343283582089 point pt 7 ps 1.8 lc rgb '#D55E00' offset 1.2,0
set label 3 'other' at screen 0.51,0.03731343283582089 point pt 7 ps 1.8 lc rgb '#E8E0C8' offset 1.2,0
set label 4 'under 2 bonds' at screen 0.745,0.03731343283582089 point pt 6 ps 1.8 lc rgb '#333333' offset 1.2,0
plot 'p1-fig1.dat' index 2 using 1:2:3:4 with circles fs solid border lc rgb '#333333' lw 0.5 fc rgb variable notitle
unset multiplot
unset output
reset
}
