% `flexlink solve` in Octave: octave-cli --norc solve.m LINK MOTION CUTOFF_HZ DIR [EVERY]
% All frequencies at once, the 2x2 blocks written out. Left out: as in solve.py.
1;

% Whoever stops this wants no octave-workspace left behind.
sigterm_dumps_octave_core (false);

function link = read_link (file)
  link = struct ("l", [], "k", [], "m", [], "n", []);
  lines = strsplit (fileread (file), "\n");
  for line = lines
    pair = strsplit (line{1}, " = ");
    if (numel (pair) < 2) continue; end
    value = str2double (pair{2});
    switch (pair{1})
      case "length"          link.l(end+1) = value;
      case "EI"              link.k(end+1) = value;
      case "mass_per_length" link.m(end+1) = value;
      case "elements"        link.n(end+1) = value;
      case "inertia"         link.hub = value;
      case "ratio"           link.kappa = 1 + 2i * value;
    end
  end
  h = repelem (link.l ./ link.n, link.n);
  link.h = h;
  link.ei = repelem (link.k, link.n);
  link.mh = repelem (link.m, link.n) .* h;
  link.x = [0, cumsum(h)];
  link.L = sum (link.l);
  link.rigid = link.hub + sum (link.mh .* (link.x(1:end-1).^2 + link.x(1:end-1) .* h + h.^2 / 3));
end

% Apparent inertia about the axis, and deflections of the nodes (columns) for a unit hub angle.
function [inertia, e] = eliminate (link, mu)
  n = numel (link.h);
  count = numel (mu);
  g11 = g12 = g21 = g22 = zeros (count, n);
  a11 = a12 = a22 = zeros (count, 1);
  for k = n:-1:1
    h = link.h(k); m = link.mh(k); s = link.ei(k) / h^3;
    if (k < n && h != link.h(k+1))
      f = h / link.h(k+1); a12 *= f; a22 *= f^2;
    end
    c11 = 12 * s * mu - 156/420 * m - a11;
    c12 = -6 * s * mu + 22/420 * m - a12;
    c22 = 4 * s * mu - 4/420 * m - a22;
    r = a11 + a12;
    t = a12 + a22;
    b11 = a11 + m/2; b12 = a12 - m/12; b21 = r + 7/20*m; b22 = t - m/20;
    d = 1 ./ (c11 .* c22 - c12 .* c12);
    c11 = c11 .* d; c12 = c12 .* d; c22 = c22 .* d;
    p = c22 .* b11 - c12 .* b12; q = c22 .* b21 - c12 .* b22;
    u = c11 .* b12 - c12 .* b11; v = c11 .* b22 - c12 .* b21;
    a22 = r + t + (b21 .* q + b22 .* v + m/3);
    a12 = r + (b11 .* q + b12 .* v + m/2);
    a11 = a11 + (b11 .* p + b12 .* u + m);
    g11(:,k) = p; g12(:,k) = q; g21(:,k) = u; g22(:,k) = v;
  end
  inertia = a22 * link.h(1)^2;
  e = zeros (count, n + 1);
  v = phi = zeros (count, 1);
  for k = 1:n
    h = link.h(k);
    if (k > 1 && h != link.h(k-1)) phi *= h / link.h(k-1); end
    x = v + link.x(k); y = phi + h;
    v = v + phi + (g11(:,k) .* x + g12(:,k) .* y);
    phi = phi + (g21(:,k) .* x + g22(:,k) .* y);
    e(:,k+1) = v;
  end
end

% Real histories (columns) of amplitudes from the first frequency on: two in one complex transform.
function x = inverse (amplitudes, samples)
  [band, count] = size (amplitudes);
  x = zeros (samples, count);
  for k = 1:2:count
    full = zeros (samples, 1);
    a = amplitudes(:,k);
    b = 0;
    if (k < count) b = amplitudes(:,k+1); end
    full(2:band+1) = a + 1i * b;
    full(samples:-1:samples-band+1) = conj (a) + 1i * conj (b);
    z = ifft (full) * samples / 2;
    x(:,k) = real (z);
    if (k < count) x(:,k+1) = imag (z); end
  end
end

function d = decimals (x)
  peak = max (abs (x(:)));
  d = 10;
  if (peak > 0) d = max (0, 10 - floor (log10 (peak))); end
end

function write (folder, name, header, places, table)
  file = fopen (fullfile (folder, name), "w");
  fprintf (file, "%s\n", header);
  row = strjoin (arrayfun (@(d) sprintf ("%%.%df", d), places, "UniformOutput", false), ",");
  half = 0.5 * 10 .^ -places;
  table(abs (table) < half) = 0;
  fprintf (file, [row "\n"], table.');
  fclose (file);
end

given = argv ();
[link_file, motion_file, cutoff_hz, folder] = given{1:4};
every = 1;
if (numel (given) > 4) every = str2double (given{5}); end
link = read_link (link_file);
file = fopen (motion_file);
table = textscan (file, "%f,%f", "HeaderLines", 1);
fclose (file);
[time, a] = table{:};
samples = numel (a);
step = (time(end) - time(1)) / (samples - 1);
spectrum = fft (a) / samples;
% A raised cosine over half the cut-off.
cutoff = 2 * pi * str2double (cutoff_hz);
band = min (ceil (1.5 * cutoff * samples * step / (2 * pi)) - 1, samples / 2 - 1);
omega = 2 * pi * (1:band).' / (samples * step);
weight = 0.5 * (1 + cos (pi * max (omega / cutoff - 1, 0) / 0.5));
% The wanted tip rests at the start.
every_rate = 2i * pi * (1:samples/2-1).' / (samples * step);
velocity = 2 * spectrum(2:samples/2) ./ every_rate;
first_rate = real (sum (velocity));
first = real (sum (velocity ./ every_rate));
spectrum = 2 * weight .* spectrum(2:band+1);
v_tip = -spectrum ./ omega.^2;

[inertia, e] = eliminate (link, link.kappa ./ omega.^2);
angle = v_tip ./ (link.L + e(:,end));
torque = -omega.^2 .* (inertia + link.hub) .* angle;
excess = -e(:,end) / link.L .* angle;
moved = e .* angle + excess .* link.x;
hub = [spectrum ./ (1i * omega), v_tip, torque, excess, 1i * omega .* excess, -omega.^2 .* excess, spectrum];
hub = inverse (hub, samples);
a = hub(:,7);
rate = hub(:,1) - first_rate;
tip = hub(:,2) - first - first_rate * (time - time(1));

mkdir (folder);
times = find (abs (round (step * 10.^(0:15)) ./ 10.^(0:15) - step) < 1e-18, 1) - 1;
write (folder, "torque.csv", "time_s,torque_n_m", [times, decimals(hub(:,3))], [time, hub(:,3)]);
rigid = link.rigid / link.L * a;
write (folder, "rigid_torque.csv", "time_s,rigid_torque_n_m", [times, decimals(rigid)], [time, rigid]);
table = [hub(:,4) + tip / link.L, hub(:,5) + rate / link.L, hub(:,6) + a / link.L, tip / link.L];
places = arrayfun (@(k) decimals (table(:,k)), 1:4);
header = "time_s,hub_angle_rad,hub_rate_rad_s,hub_acceleration_rad_s2,rigid_hub_angle_rad";
write (folder, "hub_angle.csv", header, [times, places], [time, table]);
table = [tip, rate, a];
places = arrayfun (@(k) decimals (table(:,k)), 1:3);
header = "time_s,tip_displacement_m,tip_velocity_m_s,tip_acceleration_m_s2";
write (folder, "tip.csv", header, [times, places], [time, table]);

if (mod (samples, every) == 0 && band < samples / every / 2)
  moved = inverse (moved, samples / every);
else
  moved = inverse (moved, samples)(1:every:end, :);
end
moved += tip(1:every:end) .* (link.x / link.L);
header = ["time_s", sprintf(",v%d_m", 0:numel (link.h))];
places = [times, repmat(decimals (moved), 1, numel (link.x))];
write (folder, "nodal_displacements.csv", header, places, [time(1:every:end), moved]);
