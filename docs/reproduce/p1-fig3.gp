# Onsets of bouncing and convection
# gnuplot p1-fig3.gp draws p1-fig3.svg, p1-fig3.pdf and p1-fig3.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 640,520 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 7.111111111111111in,5.777777777777778in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1024,832 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-fig3.' . kind
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
set xlabel 'N_l σ'
set xrange [5.62:83.38]
unset logscale x
set xtics 10
set format x '%g'
set ylabel 'Γ = A ω^2/g'
set yrange [0.921:3.054]
unset logscale y
set ytics 0.5
set format y '%g'
set link y2
set y2label 'K_m = A^2 ω^2/(σ g)'
set ytics nomirror
set y2tics ('1' 1.000000, '2' 1.414214, '4' 2.000000, '6' 2.449490, '9' 3.000000, '12' 3.464102, '16' 4.000000, '20' 4.472136, '25' 5.000000)
set key maxcols 2
set arrow from graph 0,first 1.81659 to graph 1,first 1.81659 nohead lw 1.5 dt 4 lc rgb '#555555'
plot 'p1-fig3.dat' index 0 using 1:2:3:4 with yerrorlines lw 1.3 ps 1.2 pt 9 lc rgb '#009E73' title 'convection, random', 'p1-fig3.dat' index 1 using 1:2:3:4 with vectors head filled lw 1.5 lc rgb '#009E73' notitle, 'p1-fig3.dat' index 2 using 1:2:3:4 with yerrorlines lw 1.3 ps 1.2 pt 7 lc rgb '#0072B2' title 'convection, crystal', 'p1-fig3.dat' index 3 using 1:2:3:4 with vectors head filled lw 1.5 lc rgb '#0072B2' notitle, 'p1-fig3.dat' index 4 using 1:2:3:4 with yerrorlines lw 1.3 ps 1.2 pt 8 lc rgb '#009E73' title 'bouncing, random', 'p1-fig3.dat' index 5 using 1:2:3:4 with vectors head filled lw 1.5 lc rgb '#009E73' notitle, 'p1-fig3.dat' index 6 using 1:2:3:4 with yerrorlines lw 1.3 ps 1.2 pt 6 lc rgb '#0072B2' title 'bouncing, crystal', 'p1-fig3.dat' index 7 using 1:2:3:4 with vectors head filled lw 1.5 lc rgb '#0072B2' notitle, 'p1-fig3.dat' index 8 using 1:2:3:4 with yerrorbars lw 1.3 ps 0.8 pt 11 lc rgb '#009E73' title 'random, none at rest', 'p1-fig3.dat' index 9 using 1:2:3:4 with vectors head filled lw 1.5 lc rgb '#009E73' notitle, keyentry with lines lw 1.5 dt 4 lc rgb '#555555' title 'paper: K_m = 3.3'
unset output
reset
}
