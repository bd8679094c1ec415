# s_b of a rigid inelastic bed
# gnuplot p1-appendix-b.gp draws p1-appendix-b.svg, p1-appendix-b.pdf and p1-appendix-b.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 640,480 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 7.111111111111111in,5.333333333333333in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1024,768 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-appendix-b.' . kind
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
set xlabel 'Γ = A ω^2/g'
set xrange [1.012:2.038]
unset logscale x
set xtics 0.2
set format x '%g'
set ylabel 's_b/σ'
set yrange [0.00210711275:1.70192126]
set logscale y
set ytics ('' 0.003 1, '' 0.004 1, 0.005, '' 0.006 1, '' 0.007 1, '' 0.008 1, '' 0.009 1, 0.01, 0.02, '' 0.03 1, '' 0.04 1, 0.05, '' 0.06 1, '' 0.07 1, '' 0.08 1, '' 0.09 1, 0.1, 0.2, '' 0.3 1, '' 0.4 1, 0.5, '' 0.6 1, '' 0.7 1, '' 0.8 1, '' 0.9 1, 1)
set format y '%g'
set arrow 1 from first 1.16359,graph 0 to first 1.16359,first 0.033333 nohead dt 2 lc rgb blue
set label 1 'Γ = 1.1636' at first 1.16359,graph 0.05 offset 0.7,0
plot 0.033333 with lines lw 1.5 dt 4 lc rgb '#555555' title 'σ/30', 'p1-appendix-b.dat' using 1:4 with lines lw 1.3 lc rgb blue notitle, '' using 1:2 with points pt 7 ps 0.9 lc rgb blue title 'variance over phases', '' using 1:5 with lines lw 1.3 lc rgb vermilion notitle, '' using 1:3 with points pt 6 ps 0.9 lc rgb vermilion title 'about the height at rest'
unset output
reset
}
