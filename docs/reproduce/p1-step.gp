# What the step does to the physics
# gnuplot p1-step.gp draws p1-step.svg, p1-step.pdf and p1-step.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 720,1160 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 8in,12.88888888888889in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1152,1856 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-step.' . kind
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
set tmargin at screen 0.9655
set bmargin at screen 0.8172
set xlabel 'steps per contact n'
set xrange [5.5496272:229.56497]
set logscale x
set xtics ('' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100, 200)
set format x '%g'
set ylabel 'T_g^{*}/converged'
set yrange [0.817774514:1.07045265]
unset logscale y
set ytics 0.05
set format y '%g'
set xtics (6.37, 12.5, 25, 50, 100, 200, 400)
set title '{/:Bold (a)} crystal'
plot 'p1-step.dat' index 0 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 1 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 2 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 3 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 4 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 5 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 6 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#CC79A7' notitle, \
     'p1-step.dat' index 7 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#CC79A7' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.9655
set bmargin at screen 0.8172
set xlabel 'steps per contact n'
set xrange [5.5496272:229.56497]
set logscale x
set xtics ('' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100, 200)
set format x '%g'
set ylabel 'T_g^{*}/converged'
set yrange [0.353693429:1.18034125]
unset logscale y
set ytics 0.2
set format y '%g'
set xtics (6.37, 12.5, 25, 50, 100, 200, 400)
set title '{/:Bold (b)} random'
plot 'p1-step.dat' index 8 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 9 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 10 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 11 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 12 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 13 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 14 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#CC79A7' notitle, \
     'p1-step.dat' index 15 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#CC79A7' notitle
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.7276
set bmargin at screen 0.5793
set xlabel 'steps per contact n'
set xrange [5.5496272:229.56497]
set logscale x
set xtics ('' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100, 200)
set format x '%g'
set ylabel 'p_s'
set yrange [-0.0268949889:0.699269712]
unset logscale y
set ytics 0.1
set format y '%g'
set xtics (6.37, 12.5, 25, 50, 100, 200, 400)
set title '{/:Bold (c)} crystal'
plot 'p1-step.dat' index 16 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 17 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 18 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 19 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 20 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 21 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 22 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#CC79A7' notitle, \
     'p1-step.dat' index 23 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#CC79A7' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.7276
set bmargin at screen 0.5793
set xlabel 'steps per contact n'
set xrange [5.5496272:229.56497]
set logscale x
set xtics ('' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100, 200)
set format x '%g'
set ylabel 'p_s'
set yrange [-0.0266273107:0.692310077]
unset logscale y
set ytics 0.1
set format y '%g'
set xtics (6.37, 12.5, 25, 50, 100, 200, 400)
set title '{/:Bold (d)} random'
plot 'p1-step.dat' index 24 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 25 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 26 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 27 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 28 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 29 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 30 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#CC79A7' notitle, \
     'p1-step.dat' index 31 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#CC79A7' notitle
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.4897
set bmargin at screen 0.3414
set xlabel 'steps per contact n'
set xrange [5.5496272:229.56497]
set logscale x
set xtics ('' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100, 200)
set format x '%g'
set ylabel 's_b/converged'
set yrange [0.972938337:1.06603953]
unset logscale y
set ytics 0.02
set format y '%g'
set xtics (6.37, 12.5, 25, 50, 100, 200, 400)
set title '{/:Bold (e)} crystal'
plot 'p1-step.dat' index 32 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 33 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 34 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 35 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 36 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 37 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 38 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#CC79A7' notitle, \
     'p1-step.dat' index 39 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#CC79A7' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.4897
set bmargin at screen 0.3414
set xlabel 'steps per contact n'
set xrange [5.5496272:229.56497]
set logscale x
set xtics ('' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100, 200)
set format x '%g'
set ylabel 's_b/converged'
set yrange [0.939351766:1.11681114]
unset logscale y
set ytics 0.05
set format y '%g'
set xtics (6.37, 12.5, 25, 50, 100, 200, 400)
set title '{/:Bold (f)} random'
plot 'p1-step.dat' index 40 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 41 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 42 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 43 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 44 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 45 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 46 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#CC79A7' notitle, \
     'p1-step.dat' index 47 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#CC79A7' notitle
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.2517
set bmargin at screen 0.1034
set xlabel 'steps per contact n'
set xrange [5.5496272:229.56497]
set logscale x
set xtics ('' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100, 200)
set format x '%g'
set ylabel 's_c/σ'
set yrange [-0.140518958:3.65349292]
unset logscale y
set ytics 0.5
set format y '%g'
set xtics (6.37, 12.5, 25, 50, 100, 200, 400)
set title '{/:Bold (g)} crystal'
plot 'p1-step.dat' index 48 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 49 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 50 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 51 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 52 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 53 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 54 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#CC79A7' notitle, \
     'p1-step.dat' index 55 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#CC79A7' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.2517
set bmargin at screen 0.1034
set xlabel 'steps per contact n'
set xrange [5.5496272:229.56497]
set logscale x
set xtics ('' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100, 200)
set format x '%g'
set ylabel 's_c/σ'
set yrange [-0.258766936:6.72794033]
unset logscale y
set ytics 1
set format y '%g'
set xtics (6.37, 12.5, 25, 50, 100, 200, 400)
set title '{/:Bold (h)} random'
plot 'p1-step.dat' index 56 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 57 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#0072B2' notitle, \
     'p1-step.dat' index 58 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 59 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#D55E00' notitle, \
     'p1-step.dat' index 60 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 61 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#009E73' notitle, \
     'p1-step.dat' index 62 using 1:2:3:4 with yerrorlines pt 7 ps 0.7 lw 1.3 dt 1 lc rgb '#CC79A7' notitle, \
     'p1-step.dat' index 63 using 1:2:3:4 with yerrorlines pt 4 ps 0.7 lw 1.3 dt 2 lc rgb '#CC79A7' notitle
set lmargin at screen 0
set rmargin at screen 1
set tmargin at screen 0.0483
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
set key at screen 0.5,0.0052 center bottom horizontal
plot [0:1][0:1] NaN notitle, keyentry with lines lw 1.8 lc rgb '#0072B2' title 'Γ = 1.5', \
     keyentry with lines lw 1.8 lc rgb '#D55E00' title 'Γ = 2', \
     keyentry with lines lw 1.8 lc rgb '#009E73' title 'Γ = 2.5', \
     keyentry with lines lw 1.8 lc rgb '#CC79A7' title 'Γ = 3', \
     keyentry with linespoints pt 7 lc rgb '#333333' title 'Verlet', \
     keyentry with linespoints pt 4 dt 2 lc rgb '#333333' title 'split'
unset multiplot
unset output
reset
}
