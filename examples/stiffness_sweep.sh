#!/usr/bin/env bash
# How torque, lead and lag depend on the stiffness of a link: a table and its plot.
#
#     examples/stiffness_sweep.sh specs/bayo1987_example1.toml trajectories/sine_0.88s.csv stiffness
#
# writes stiffness.csv and stiffness.svg; gnuplot draws the plot.
set -euo pipefail

usage='usage: stiffness_sweep.sh LINK MOTION [NAME]'
link=${1:?$usage} motion=${2:?$usage} name=${3:-stiffness}

flexlink sweep "$link" "$motion" --vary 'segments.*.EI*=0.5:32:60:log' -o "$name.csv"

# The name goes through the environment: it may hold quotes and blanks.
export name
gnuplot <<'PLOT'
name = system('printf %s "$name"')
set terminal svg size 720,520 dynamic font 'sans-serif,13' background 'white'
set output name.'.svg'
set datafile separator ','
set logscale x 2
set xlabel 'bending stiffness EI over that of the file'
set grid
set lmargin 10
set multiplot layout 2,1
set ylabel 'peak torque over rigid'
set yrange [0:1.1]
set key bottom right
plot name.'.csv' using (column('segments.*.EI*')):(column('torque_ratio')) \
    with lines lw 2 title 'peak torque', 1 with lines dt 2 lc rgb 'gray40' title 'rigid link'
set ylabel 'time [s]'
set yrange [0:*]
set key top right
plot name.'.csv' using (column('segments.*.EI*')):(column('lead_s')) with lines lw 2 title 'lead', \
    '' using (column('segments.*.EI*')):(column('lag_s')) with lines lw 2 title 'lag'
unset multiplot
PLOT
echo "plotted  $name.svg"
