# Onsets of bouncing and convection
# gnuplot p1-fig3.gp draws p1-fig3.svg, p1-fig3.pdf and p1-fig3.png
blue = '#0072B2'
orange = '#E69F00'
vermilion = '#D55E00'
green = '#009E73'
sky = '#56B4E9'
purple = '#CC79A7'
grey = '#9A9A9A'
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 620,480 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 6.888888888888889in,5.333333333333333in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 992,768 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-fig3.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set xrange [0:*]
set yrange [0.9:*]
set link y2
set offsets 0,0,graph 0.06,0
set xlabel 'N_l σ'
set ylabel 'Γ'
set y2label 'K_m'
set ytics nomirror
set y2tics ('1' 1.000000, '2' 1.414214, '4' 2.000000, '6' 2.449490, '9' 3.000000, '12' 3.464102, '16' 4.000000, '20' 4.472136, '25' 5.000000)
set key above
plot 'p1-fig3.dat' index 0 using 1:2:3:4 with yerrorlines lw 1.3 ps 1.2 pt 9 lc rgb '#009E73' title 'convection, random', 'p1-fig3.dat' index 1 using 1:2:3:4 with vectors head filled lw 1.5 lc rgb '#009E73' notitle, 'p1-fig3.dat' index 2 using 1:2:3:4 with yerrorlines lw 1.3 ps 1.2 pt 7 lc rgb '#0072B2' title 'convection, crystal', 'p1-fig3.dat' index 3 using 1:2:3:4 with vectors head filled lw 1.5 lc rgb '#0072B2' notitle, 'p1-fig3.dat' index 4 using 1:2:3:4 with yerrorlines lw 1.3 ps 1.2 pt 8 lc rgb '#009E73' title 'bouncing, random', 'p1-fig3.dat' index 5 using 1:2:3:4 with vectors head filled lw 1.5 lc rgb '#009E73' notitle, 'p1-fig3.dat' index 6 using 1:2:3:4 with yerrorlines lw 1.3 ps 1.2 pt 6 lc rgb '#0072B2' title 'bouncing, crystal', 'p1-fig3.dat' index 7 using 1:2:3:4 with vectors head filled lw 1.5 lc rgb '#0072B2' notitle
unset output
reset
}
