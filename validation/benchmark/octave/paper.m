% The method of the paper: upwind differences on the full grid, one LU factorisation.
%
% usage: octave-cli paper.m DELTA MU_D P LAMBDA
%
% mu_s = tau = 1, b(v) = -v, all levels of the noise. Solves (lambda - M) u = f for the indicators
% of sticking and of |x| <= mu_s and for v^2; prints lambda u at the exit state (x_{k+1}, +1, 0), and
% the seconds of assembly, factorisation and solves.
1;

function M = generator(x, v, sgn, static, mu_d, delta, p)
  % Jumps of the noise, and differences in v against the flow. Columns of x are points of one v.
  [levels, points] = size(x);
  n = levels * points;
  number = reshape(1:n, levels, points);
  rate = 2 / delta^2;
  up = rate * (1 - delta * x / 2) / 2;
  up(1, :) = rate;
  up(end, :) = 0;
  force = x - v - mu_d * sgn;
  force(static) = 0;
  value = {up, rate - up, max(force, 0) * p / delta, max(-force, 0) * p / delta};
  offset = [1, -1, levels, -levels];
  M = sparse(n, n);
  for m = 1:4
    from = find(value{m} > 0);
    M = M + sparse(from, from + offset(m), value{m}(from), n, n);
  end
  M = M - spdiags(full(sum(M, 2)), 0, n, n);
end

parameters = cellfun(@str2double, argv());
if numel(parameters) != 4
  error("usage: octave-cli paper.m DELTA MU_D P LAMBDA");
end
delta = parameters(1);
mu_d = parameters(2);
p = parameters(3);
lambda = parameters(4);

start = tic();
N = round(2 / delta^2);
k = floor(1 / delta + 1e-9);
[i, j] = ndgrid(-N:N, -N*p:N*p);
x = i * delta;
v = j * delta / p;
static = j == 0 & abs(i) <= k;
sgn = sign(j);
sgn(j == 0) = sign(i(j == 0));
sgn(static) = 0;

A = lambda * speye(numel(x)) - generator(x, v, sgn, static, mu_d, delta, p);
f = [static(:), v(:).^2, abs(i(:)) <= k];
[L, U, P, Q, R] = lu(A);
u = lambda * (Q * (U \ (L \ (P * (R \ double(f))))));
here = find(i == k + 1 & j == 0);

printf("P_stick %.16g\nE_V2 %.16g\nP_X_le_mu_s %.16g\n", u(here, :));
printf("seconds %.6g\n", toc(start));
