# s_b of a rigid inelastic bed
# gnuplot p1-appendix-b.gp draws p1-appendix-b.svg, p1-appendix-b.pdf and p1-appendix-b.png
blue = '#0072B2'
orange = '#E69F00'
vermilion = '#D55E00'
green = '#009E73'
sky = '#56B4E9'
purple = '#CC79A7'
grey = '#9A9A9A'
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 540,400 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 6in,4.444444444444445in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 864,640 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-appendix-b.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set logscale y
set xrange [1.03:2.03]
set yrange [0.002:2]
set xlabel 'Γ'
set ylabel 's_b / σ'
set key bottom right
set arrow 1 from first 1.16359,graph 0 to first 1.16359,first 0.033333 nohead dt 2 lc rgb blue
set label 1 'Γ = 1.1636' at first 1.16359,graph 0.05 offset 0.7,0
plot 0.033333 with lines dt 4 lw 1.5 lc rgb '#666666' title 'σ/30', 'p1-appendix-b.dat' using 1:4 with lines lw 1.3 lc rgb blue notitle, '' using 1:2 with points pt 7 ps 0.9 lc rgb blue title 'variance over phases', '' using 1:5 with lines lw 1.3 lc rgb vermilion notitle, '' using 1:3 with points pt 6 ps 0.9 lc rgb vermilion title 'about the height at rest'
unset output
reset
}
