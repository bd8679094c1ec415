# One collision
# gnuplot p1-appendix-a.gp draws p1-appendix-a.svg, p1-appendix-a.pdf and p1-appendix-a.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 720,400 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 8in,4.444444444444445in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1152,640 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-appendix-a.' . kind
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
set tmargin at screen 0.9000
set bmargin at screen 0.2400
set xlabel 't / 10^{-3} t_0'
set xrange [-0.12582108:3.27134808]
unset logscale x
set xtics 0.5
set format x '%g'
set ylabel 'overlap δ / 10^{-4} σ'
set yrange [-0.4:10.4]
unset logscale y
set ytics 2
set format y '%g'
set title '{/:Bold (a)} overlap'
plot 'p1-appendix-a.dat' index 0 using 1:2 with points pt 6 ps 0.7 lc rgb '#0072B2' notitle, [0:2.22283] 7.07549138*exp(-0.05*x)*sin(1.4133294*x) with lines lw 1.3 lc rgb '#0072B2' notitle, 'p1-appendix-a.dat' index 1 using 1:2 with points pt 8 ps 0.7 lc rgb '#D55E00' notitle, [0:3.14553] 10.0125235*exp(-0.05*x)*sin(0.998749218*x) with lines lw 1.3 lc rgb '#D55E00' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.9000
set bmargin at screen 0.2400
set xlabel 't / 10^{-3} t_0'
set xrange [-0.12582108:3.27134808]
unset logscale x
set xtics 0.5
set format x '%g'
set ylabel 'normal force F_n / 10^2 m g'
set yrange [-1.44:10.44]
unset logscale y
set ytics 2
set format y '%g'
set title '{/:Bold (b)} force'
set xzeroaxis lw 1 lc rgb '#444444'
plot 'p1-appendix-a.dat' index 0 using 1:3 with points pt 6 ps 0.7 lc rgb '#0072B2' notitle, [0:2.22283] 7.07549138*exp(-0.05*x)*sin(1.4133294*x) + 0.353774569*exp(-0.05*x)*(1.4133294*cos(1.4133294*x)-0.05*sin(1.4133294*x)) with lines lw 1.3 lc rgb '#0072B2' notitle, 'p1-appendix-a.dat' index 1 using 1:3 with points pt 8 ps 0.7 lc rgb '#D55E00' notitle, [0:3.14553] 10.0125235*exp(-0.05*x)*sin(0.998749218*x) + 1.00125235*exp(-0.05*x)*(0.998749218*cos(0.998749218*x)-0.05*sin(0.998749218*x)) with lines lw 1.3 lc rgb '#D55E00' notitle
set lmargin at screen 0
set rmargin at screen 1
set tmargin at screen 0.0800
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
set key at screen 0.5,0.0150 center bottom horizontal
plot [0:1][0:1] NaN notitle, keyentry with points pt 6 lc rgb '#0072B2' title 'bead-bead', keyentry with points pt 8 lc rgb '#D55E00' title 'bead-wall', \
     keyentry with lines lw 1.8 lc rgb '#333333' title 'closed form'
unset multiplot
unset output
reset
}
