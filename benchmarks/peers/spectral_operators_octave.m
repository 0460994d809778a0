% SPDX-License-Identifier: GPL-3.0-or-later
% Octave baseline for any packing: rho(B_eps) from the operators of `nscdd export --operators --sparse-only`, by the
% method of spectral_operators_scipy.py: a sparse Cholesky factor per subdomain, a dense interface matrix, its largest
% eigenvalue by LAPACK. The rigid limit is out of its reach.
% usage: octave-cli --no-gui -q spectral_operators_octave.m FOLDER EPSILON
args = argv(); folder = args{1}; epsilon = str2double(args{2});

function matrix = read(folder, name)
  file = fopen(fullfile(folder, [name ".mtx"]), "r");
  kind = fgetl(file);
  line = fgetl(file);
  while line(1) == "%", line = fgetl(file); end
  counts = sscanf(line, "%d");
  entries = fscanf(file, "%g", [3 counts(3)]);
  fclose(file);
  matrix = sparse(entries(1, :), entries(2, :), entries(3, :), counts(1), counts(2));
  if strfind(kind, "symmetric"), matrix = matrix + tril(matrix, -1)'; end
end

parts = numel(glob(fullfile(folder, "M_*.mtx")));
m = h = a = cell(parts, 1);
for e = 1:parts
  m{e} = read(folder, sprintf("M_%d", e - 1)); h{e} = read(folder, sprintf("H_%d", e - 1));
  a{e} = read(folder, sprintf("A_%d", e - 1));
end
n = rows(a{1});
start = tic;
s = x = zeros(n);
for e = 1:parts
  own = find(any(a{e}, 2));
  gluing = a{e}(own, :);
  [r, failed, q] = chol(m{e} + h{e} * h{e}' / epsilon, "vector");
  if failed, error("no Cholesky factor"); end
  y = r' \ full(gluing(:, q)');
  s(own, own) += y' * y;
  x(own, own) += gluing * (m{e} \ gluing');
end
l = chol(x, "lower");
b = eye(n) - l \ (l \ s)';
printf("unknowns=%d rho=%.12g total=%.3fs\n", n, max(eig((b + b') / 2)), toc(start));
