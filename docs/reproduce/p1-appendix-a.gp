# One collision
# gnuplot p1-appendix-a.gp draws p1-appendix-a.svg, p1-appendix-a.pdf and p1-appendix-a.png
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
set output 'p1-appendix-a.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set multiplot layout 1,2
set xrange [0:3.4]
set xlabel 't / 10^{-3} t_0'
set key top right
set ylabel 'overlap δ / 10^{-4} σ'
set yrange [0:12.5]
plot 'p1-appendix-a.dat' index 0 using 1:2 with points pt 6 ps 0.7 lc rgb '#0072B2' title 'bead-bead', [0:2.22283] 7.07549138*exp(-0.05*x)*sin(1.4133294*x) with lines lw 1.3 lc rgb '#0072B2' notitle, 'p1-appendix-a.dat' index 1 using 1:2 with points pt 8 ps 0.7 lc rgb '#D55E00' title 'bead-wall', [0:3.14553] 10.0125235*exp(-0.05*x)*sin(0.998749218*x) with lines lw 1.3 lc rgb '#D55E00' notitle
set ylabel 'normal force F_n / 10^2 m g'
set yrange [-2:12.5]
set xzeroaxis lw 1 lc rgb '#444444'
plot 'p1-appendix-a.dat' index 0 using 1:3 with points pt 6 ps 0.7 lc rgb '#0072B2' title 'bead-bead', [0:2.22283] 7.07549138*exp(-0.05*x)*sin(1.4133294*x) + 0.353774569*exp(-0.05*x)*(1.4133294*cos(1.4133294*x)-0.05*sin(1.4133294*x)) with lines lw 1.3 lc rgb '#0072B2' notitle, 'p1-appendix-a.dat' index 1 using 1:3 with points pt 8 ps 0.7 lc rgb '#D55E00' title 'bead-wall', [0:3.14553] 10.0125235*exp(-0.05*x)*sin(0.998749218*x) + 1.00125235*exp(-0.05*x)*(0.998749218*cos(0.998749218*x)-0.05*sin(0.998749218*x)) with lines lw 1.3 lc rgb '#D55E00' notitle
unset multiplot
unset output
reset
}
