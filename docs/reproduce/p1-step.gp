# What the step does to the physics
# gnuplot p1-step.gp draws p1-step.svg, p1-step.pdf and p1-step.png
blue = '#0072B2'
orange = '#E69F00'
vermilion = '#D55E00'
green = '#009E73'
sky = '#56B4E9'
purple = '#CC79A7'
grey = '#9A9A9A'
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 1180,620 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 13.11111111111111in,6.888888888888889in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1888,992 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-step.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set multiplot layout 2,4
set logscale x
set xrange [5:280]
set xlabel 'steps per contact n'
set lmargin 8
set xtics (6.37, 12.5, 25, 50, 100, 200, 400)
set xtics rotate by -45
set title 'crystal'
set ylabel 'T_g^{*}/T_g^{*}(converged)' offset 1.5,0
unset key
set yrange [*:*]
plot 'p1-step.dat' index 0 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#0072B2' title '{/Symbol G} = 1.5', \
     'p1-step.dat' index 1 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 2 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#D55E00' title '{/Symbol G} = 2', \
     'p1-step.dat' index 3 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 4 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#009E73' title '{/Symbol G} = 2.5', \
     'p1-step.dat' index 5 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 6 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#CC79A7' title '{/Symbol G} = 3', \
     'p1-step.dat' index 7 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#CC79A7' notitle
set title 'crystal'
set ylabel 'p_s' offset 1.5,0
set key top left samplen 1
set yrange [0:*]
plot 'p1-step.dat' index 8 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#0072B2' title '{/Symbol G} = 1.5', \
     'p1-step.dat' index 9 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 10 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#D55E00' title '{/Symbol G} = 2', \
     'p1-step.dat' index 11 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 12 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#009E73' title '{/Symbol G} = 2.5', \
     'p1-step.dat' index 13 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 14 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#CC79A7' title '{/Symbol G} = 3', \
     'p1-step.dat' index 15 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#CC79A7' notitle
set title 'crystal'
set ylabel 's_b/s_b(converged)' offset 1.5,0
unset key
set yrange [*:*]
plot 'p1-step.dat' index 16 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#0072B2' title '{/Symbol G} = 1.5', \
     'p1-step.dat' index 17 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 18 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#D55E00' title '{/Symbol G} = 2', \
     'p1-step.dat' index 19 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 20 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#009E73' title '{/Symbol G} = 2.5', \
     'p1-step.dat' index 21 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 22 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#CC79A7' title '{/Symbol G} = 3', \
     'p1-step.dat' index 23 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#CC79A7' notitle
set title 'crystal'
set ylabel 's_c/{/Symbol s}' offset 1.5,0
unset key
set yrange [0:*]
plot 'p1-step.dat' index 24 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#0072B2' title '{/Symbol G} = 1.5', \
     'p1-step.dat' index 25 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 26 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#D55E00' title '{/Symbol G} = 2', \
     'p1-step.dat' index 27 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 28 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#009E73' title '{/Symbol G} = 2.5', \
     'p1-step.dat' index 29 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 30 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#CC79A7' title '{/Symbol G} = 3', \
     'p1-step.dat' index 31 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#CC79A7' notitle
set title 'random'
set ylabel 'T_g^{*}/T_g^{*}(converged)' offset 1.5,0
unset key
set yrange [*:*]
plot 'p1-step.dat' index 32 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#0072B2' title '{/Symbol G} = 1.5', \
     'p1-step.dat' index 33 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 34 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#D55E00' title '{/Symbol G} = 2', \
     'p1-step.dat' index 35 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 36 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#009E73' title '{/Symbol G} = 2.5', \
     'p1-step.dat' index 37 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 38 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#CC79A7' title '{/Symbol G} = 3', \
     'p1-step.dat' index 39 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#CC79A7' notitle
set title 'random'
set ylabel 'p_s' offset 1.5,0
unset key
set yrange [0:*]
plot 'p1-step.dat' index 40 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#0072B2' title '{/Symbol G} = 1.5', \
     'p1-step.dat' index 41 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 42 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#D55E00' title '{/Symbol G} = 2', \
     'p1-step.dat' index 43 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 44 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#009E73' title '{/Symbol G} = 2.5', \
     'p1-step.dat' index 45 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 46 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#CC79A7' title '{/Symbol G} = 3', \
     'p1-step.dat' index 47 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#CC79A7' notitle
set title 'random'
set ylabel 's_b/s_b(converged)' offset 1.5,0
unset key
set yrange [*:*]
plot 'p1-step.dat' index 48 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#0072B2' title '{/Symbol G} = 1.5', \
     'p1-step.dat' index 49 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 50 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#D55E00' title '{/Symbol G} = 2', \
     'p1-step.dat' index 51 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 52 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#009E73' title '{/Symbol G} = 2.5', \
     'p1-step.dat' index 53 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 54 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#CC79A7' title '{/Symbol G} = 3', \
     'p1-step.dat' index 55 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#CC79A7' notitle
set title 'random'
set ylabel 's_c/{/Symbol s}' offset 1.5,0
unset key
set yrange [0:*]
plot 'p1-step.dat' index 56 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#0072B2' title '{/Symbol G} = 1.5', \
     'p1-step.dat' index 57 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 58 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#D55E00' title '{/Symbol G} = 2', \
     'p1-step.dat' index 59 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 60 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#009E73' title '{/Symbol G} = 2.5', \
     'p1-step.dat' index 61 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 62 using 1:2:3:4 with yerrorlines pt 7 ps 0.8 lw 1.2 dt 1 lc rgb '#CC79A7' title '{/Symbol G} = 3', \
     'p1-step.dat' index 63 using 1:2:3:4 with yerrorlines pt 4 ps 0.8 lw 1.2 dt 2 lc rgb '#CC79A7' notitle
unset multiplot
unset output
reset
}
