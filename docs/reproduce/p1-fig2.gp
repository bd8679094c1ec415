# Orientations of the lattice at a side wall
# gnuplot p1-fig2.gp draws p1-fig2.svg, p1-fig2.pdf and p1-fig2.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 720,330 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 8in,3.6666666666666665in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1152,528 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-fig2.' . kind
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
unset grid
set lmargin at screen 0.01
set rmargin at screen 0.3
set bmargin at screen 0.16
set tmargin at screen 0.86
set size ratio -1
unset tics
unset border
unset key
set xrange [-0.6:6]
set yrange [-0.6:6]
set title '{/:Bold (a)} orientation A'
set object 1 rectangle from -0.5,0 to 0,6 fs solid 0.6 noborder fc rgb '#888888' front
set object 2 rectangle from -0.5,-0.5 to 6,0 fs solid 0.6 noborder fc rgb '#888888' front
plot 'p1-fig2.dat' index 0 using 1:2:3 with circles fs solid border lc rgb '#333333' fc rgb '#56B4E9'
unset object 1
unset object 2
set lmargin at screen 0.32
set rmargin at screen 0.61
set bmargin at screen 0.16
set tmargin at screen 0.86
set size ratio -1
unset tics
unset border
unset key
set xrange [-0.6:6]
set yrange [-0.6:6]
set title '{/:Bold (b)} orientation B'
set object 1 rectangle from -0.5,0 to 0,6 fs solid 0.6 noborder fc rgb '#888888' front
set object 2 rectangle from -0.5,-0.5 to 6,0 fs solid 0.6 noborder fc rgb '#888888' front
plot 'p1-fig2.dat' index 1 using 1:2:3 with circles fs solid border lc rgb '#333333' fc rgb '#E69F00'
unset object 1
unset object 2
set lmargin at screen 0.74
set rmargin at screen 0.98
set tmargin at screen 0.86
set bmargin at screen 0.36
set size noratio
set border
set tics
set xtics 8 scale 0
set ytics 0.2
set xrange [0.3:32.7]
set yrange [0:1]
set title '{/:Bold (c)} random, N_l = 60'
set xlabel 'beds, by share of A'
set ylabel 'share of ordered beads' offset 1,0
set boxwidth 0.8
set style fill solid noborder
plot 'p1-fig2.dat' index 2 using 1:($2+$3+$4) with boxes lc rgb '#E69F00' notitle, '' index 2 using 1:($2+$3) with boxes lc rgb '#DDDDDD' notitle, '' index 2 using 1:2 with boxes lc rgb '#56B4E9' notitle, 1./3 with lines lw 1.5 dt 4 lc rgb '#555555' notitle, 2./3 with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0
set rmargin at screen 1
set tmargin at screen 0.0970
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
set key at screen 0.5,0.0182 center bottom horizontal
plot [0:1][0:1] NaN notitle, keyentry with boxes lc rgb '#56B4E9' title 'A', \
     keyentry with boxes lc rgb '#DDDDDD' title 'between', \
     keyentry with boxes lc rgb '#E69F00' title 'B', \
     keyentry with lines lw 1.5 dt 4 lc rgb '#555555' title 'by chance'
unset multiplot
unset output
reset
}
