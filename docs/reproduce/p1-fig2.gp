# Orientations of the lattice at a side wall
# gnuplot p1-fig2.gp draws p1-fig2.svg, p1-fig2.pdf and p1-fig2.png
blue = '#0072B2'
orange = '#E69F00'
vermilion = '#D55E00'
green = '#009E73'
sky = '#56B4E9'
purple = '#CC79A7'
grey = '#9A9A9A'
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 760,360 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 8.444444444444445in,4in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1216,576 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-fig2.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set multiplot
unset grid
set lmargin at screen 0.02
set rmargin at screen 0.32
set bmargin at screen 0.14
set tmargin at screen 0.9
set size ratio -1
unset tics
unset border
unset key
set xrange [-0.6:6]
set yrange [-0.6:6]
set title 'orientation A'
set object 1 rectangle from -0.5,0 to 0,6 fs solid 0.6 noborder fc rgb '#888888' front
set object 2 rectangle from -0.5,-0.5 to 6,0 fs solid 0.6 noborder fc rgb '#888888' front
plot 'p1-fig2.dat' index 0 using 1:2:3 with circles fs solid border lc rgb '#333333' fc rgb '#56B4E9'
unset object 1
unset object 2
set lmargin at screen 0.34
set rmargin at screen 0.64
set bmargin at screen 0.14
set tmargin at screen 0.9
set size ratio -1
unset tics
unset border
unset key
set xrange [-0.6:6]
set yrange [-0.6:6]
set title 'orientation B'
set object 1 rectangle from -0.5,0 to 0,6 fs solid 0.6 noborder fc rgb '#888888' front
set object 2 rectangle from -0.5,-0.5 to 6,0 fs solid 0.6 noborder fc rgb '#888888' front
plot 'p1-fig2.dat' index 1 using 1:2:3 with circles fs solid border lc rgb '#333333' fc rgb '#E69F00'
unset object 1
unset object 2
set lmargin at screen 0.76
set rmargin at screen 0.97
set tmargin at screen 0.68
set size noratio
set border
set tics
set xtics 1 scale 0
set ytics 0.2
set xrange [0.3:8.7]
set yrange [0:1]
set title 'random beds' offset 0,4.2
set xlabel 'bed' offset 0,0.4
set ylabel 'share of ordered beads' offset 1,0
set key at screen 0.965,0.9 vertical samplen 1.2 spacing 0.95
set boxwidth 0.8
set style fill solid border lc rgb '#333333'
plot 'p1-fig2.dat' index 2 using 1:($2+$3+$4) with boxes lc rgb orange title 'B', '' index 2 using 1:($2+$3) with boxes lc rgb '#DDDDDD' title 'between', '' index 2 using 1:2 with boxes lc rgb sky title 'A'
unset multiplot
unset output
reset
}
