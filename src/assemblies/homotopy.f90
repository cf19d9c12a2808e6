!> All solutions of a bilinear system f(x, y) = 0 by continuation: from the solutions of g = 0, of which each equation
!> is the product of a linear form in x and one in y, along
!>
!>    h(x, y, t) = (1 - t) f(x, y) + t g(x, y),   t from 1 to 0.
!>
!> With complex forms by chance no two paths meet before t = 0; each solution that stands alone is the end of a path,
!> and each set of others has the end of one (Morgan and Sommese, Appl. Math. Comput. 24 (1987) 101-113;
!> Sommese and Wampler, The Numerical Solution of Systems of Polynomials, 2005). The chance is always the same.
!> Coordinates are homogeneous, x . u = 1 and y . v = 1 with u and v by chance: paths to infinity have ends as others.
module homotopy
   use kinds, only: wp
   use planar, only: pi
   use complex_lu, only: factor_complex, solve_complex
   use bilinear, only: bilinear_t, path_end_t, ends_t, derivatives_at, path_count, finiteness, infinity_level
   implicit none
   private
   public :: follow_paths

   !> The system with its start, and the room of a step. z = (x, y).
   type :: paths_t
      type(bilinear_t) :: f
      complex(wp), allocatable :: a(:, :), b(:, :)    !< (0:p, 2p) of the start's linear forms
      complex(wp), allocatable :: patch(:, :)         !< (0:p, 2) u and v
      real(wp) :: careful = 1.0_wp                    !< predictions are corrected by less than this part of the usual
   end type paths_t

   !> The correction of a prediction that is aimed at, and the largest, in parts of z: paths that are further apart are
   !> not mistaken for one another.
   real(wp), parameter :: aim = 1.0e-5_wp, largest = 1.0e-3_wp
   !> Corrections below this part of z are rounding.
   real(wp), parameter :: converged = max(1.0e-11_wp, 4096.0_wp*epsilon(1.0_wp))
   integer, parameter :: max_corrections = 4
   real(wp), parameter :: first_step = 0.05_wp, least_step = 1.0e-5_wp
   !> From here on t falls by tenths, and from each of them the end is tried in a few steps: a path that does not reach
   !> it so has a singular end, unless its neighbour is nearer to it than about the root of the last of them.
   real(wp), parameter :: near_end = 0.1_wp, tenth = 0.1_wp, least_to_end = 0.1_wp
   integer, parameter :: max_tenths = nint(-log10(epsilon(1.0_wp))) - 3
   !> x . u of a path to infinity falls with t at this power or more: 1 over the number of paths that meet there.
   real(wp), parameter :: least_power = 0.04_wp
   !> Tenths of t before a path that fails tells where it goes.
   integer, parameter :: least_tenths = 4
   !> Ends that differ by less, in parts of z, are one; all paths are followed anew, with steps so much shorter.
   real(wp), parameter :: alike = max(1.0e-8_wp, sqrt(epsilon(1.0_wp)))
   real(wp), parameter :: shorter = 1.0e-2_wp
   !> Singular ends that differ by less may be one: four that meet are known to the fourth root of the last t.
   real(wp), parameter :: blurred = 1.0e-2_wp
   integer, parameter :: max_rounds = 3

contains

   !> The `ends` of all paths of `f`, p from 1. `moves`: some are points of a curve of solutions.
   subroutine follow_paths(f, ends, moves)
      type(bilinear_t), intent(in) :: f
      type(ends_t), intent(out) :: ends
      logical, intent(out) :: moves
      type(paths_t) :: h
      type(ends_t) :: found
      integer :: round

      do round = 1, max_rounds
         call make_start(f, round, h)
         call follow_all(h, found)
         if (round == 1 .or. worth(found) > worth(ends)) ends = found
         if (found%failed == 0) exit
      end do
      moves = .false.
      if (.not. any(ends%list%is_singular)) return
      ! Paths from another start come to the same solutions, but to other points of a curve.
      call make_start(f, max_rounds + 1, h)
      call follow_all(h, found)
      do round = 1, size(ends%list)
         if (ends%list(round)%is_singular) moves = moves .or. .not. is_among(f, ends%list(round), found%list)
      end do

   contains

      !> Paths of `e` of which the end is known.
      pure integer function worth(e)
         type(ends_t), intent(in) :: e

         worth = e%paths - e%failed
      end function worth
   end subroutine follow_paths

   !> A singular solution of `list` is that of `e`, as far as rounding leaves it known.
   logical function is_among(f, e, list)
      type(bilinear_t), intent(in) :: f
      type(path_end_t), intent(in) :: e, list(:)
      complex(wp) :: x(f%p + 1), y(f%p + 1)
      integer :: k

      is_among = .false.
      do k = 1, size(list)
         if (.not. list(k)%is_singular) cycle
         x = list(k)%x*(sum(f%plane*e%x)/sum(f%plane*list(k)%x))
         y = list(k)%y*(sum(conjg(f%plane)*e%y)/sum(conjg(f%plane)*list(k)%y))
         is_among = is_among .or. (maxval(abs(x - e%x)) <= blurred*maxval(abs(x)) .and. &
            maxval(abs(y - e%y)) <= blurred*maxval(abs(y)))
      end do
   end function is_among

   !> The start of round number `round`: each has a chance of its own.
   subroutine make_start(f, round, h)
      type(bilinear_t), intent(in) :: f
      integer, intent(in) :: round
      type(paths_t), intent(out) :: h
      integer :: seed, j, k

      h%f = f
      h%careful = shorter**mod(round - 1, max_rounds)
      allocate (h%a(0:f%p, 2*f%p), h%b(0:f%p, 2*f%p), h%patch(0:f%p, 2))
      seed = 1987*round
      do j = 1, 2*f%p
         do k = 0, f%p
            h%a(k, j) = on_circle(seed)
            h%b(k, j) = on_circle(seed)
         end do
      end do
      do k = 0, f%p
         h%patch(k, 1) = on_circle(seed)
         h%patch(k, 2) = on_circle(seed)
      end do
   end subroutine make_start

   !> A complex number of size 1, by chance (Park and Miller, Comm. ACM 31 (1988) 1192-1201).
   complex(wp) function on_circle(seed) result(z)
      integer, intent(inout) :: seed

      ! Schrage's way: 16807 seed modulo 2^31 - 1 in the range of integers.
      seed = 16807*mod(seed, 127773) - 2836*(seed/127773)
      if (seed < 0) seed = seed + huge(seed)
      z = exp(cmplx(0.0_wp, 2.0_wp*pi*(real(seed, wp)/real(huge(seed), wp)), wp))
   end function on_circle

   !> Follows every path. Two that come to one regular end have jumped on the way: they have failed.
   subroutine follow_all(h, ends)
      type(paths_t), intent(in) :: h
      type(ends_t), intent(out) :: ends
      type(path_end_t), allocatable :: list(:)
      integer :: chosen(h%f%p), count_of, k, j
      complex(wp) :: z(2*h%f%p + 2)
      logical :: is_done, is_infinite, is_twin(path_count(h%f%p))

      ends%paths = path_count(h%f%p)
      allocate (list(ends%paths))
      count_of = 0
      chosen = [(k, k=1, h%f%p)]
      do
         call start_path(h, chosen, z)
         call follow_path(h, z, list(count_of + 1), is_infinite, is_done)
         if (.not. is_done) ends%failed = ends%failed + 1
         if (is_done .and. is_infinite) ends%infinite = ends%infinite + 1
         if (is_done .and. .not. is_infinite) count_of = count_of + 1
         if (.not. next_choice(chosen, 2*h%f%p)) exit
      end do
      is_twin = .false.
      do k = 2, count_of
         do j = 1, k - 1
            if (list(k)%is_singular .or. list(j)%is_singular .or. is_twin(j)) cycle
            is_twin(k) = is_twin(k) .or. all(abs(list(k)%x - list(j)%x) <= alike*maxval(abs(list(k)%x))) &
               .and. all(abs(list(k)%y - list(j)%y) <= alike*maxval(abs(list(k)%y)))
         end do
      end do
      ends%failed = ends%failed + count(is_twin)
      ends%list = pack(list(:count_of), .not. is_twin(:count_of))
   end subroutine follow_all

   !> The next of all choices of size(chosen) numbers up to `n`, in increasing order; false after the last.
   logical function next_choice(chosen, n) result(is_there)
      integer, intent(inout) :: chosen(:)
      integer, intent(in) :: n
      integer :: k, j

      is_there = .false.
      do k = size(chosen), 1, -1
         if (chosen(k) == n - size(chosen) + k) cycle
         is_there = .true.
         chosen(k:) = [(chosen(k) + j, j=1, size(chosen) - k + 1)]
         return
      end do
   end function next_choice

   !> The solution `z` of the start in which the forms in x of the equations `chosen` are zero, in y of the others.
   subroutine start_path(h, chosen, z)
      type(paths_t), intent(in) :: h
      integer, intent(in) :: chosen(:)
      complex(wp), intent(out) :: z(:)
      complex(wp), dimension(0:h%f%p, 0:h%f%p) :: left, right
      integer :: pivots(0:h%f%p), j, rows(2)
      logical :: is_singular

      rows = 0
      do j = 1, 2*h%f%p
         if (any(chosen == j)) then
            left(rows(1), :) = h%a(:, j)
            rows(1) = rows(1) + 1
         else
            right(rows(2), :) = h%b(:, j)
            rows(2) = rows(2) + 1
         end if
      end do
      associate (p => h%f%p)
         left(p, :) = h%patch(:, 1)
         right(p, :) = h%patch(:, 2)
         z = 0.0_wp
         z(p + 1) = 1.0_wp
         z(2*p + 2) = 1.0_wp
         call factor_complex(p + 1, left, pivots, is_singular)
         call solve_complex(p + 1, left, pivots, z(:p + 1))
         call factor_complex(p + 1, right, pivots, is_singular)
         call solve_complex(p + 1, right, pivots, z(p + 2:))
      end associate
   end subroutine start_path

   !> Follows the path from `z` at t = 1. `e`: its end; `is_done`: it was found.
   subroutine follow_path(h, z, e, is_infinite, is_done)
      type(paths_t), intent(in) :: h
      complex(wp), intent(inout) :: z(:)
      type(path_end_t), intent(inout) :: e
      logical, intent(out) :: is_infinite, is_done
      complex(wp) :: last(size(z))
      real(wp) :: t, finite(0:max_tenths)
      integer :: k

      is_infinite = .false.
      t = near_end
      call follow(h, 1.0_wp, t, least_step, z, is_done)
      if (.not. is_done) return
      do k = 0, max_tenths
         finite(k) = finiteness(h%f, z(:h%f%p + 1), z(h%f%p + 2:))
         last = z
         call follow(h, t, 0.0_wp, least_to_end, last, is_done)
         if (is_done) then
            z = last
            is_infinite = finiteness(h%f, z(:h%f%p + 1), z(h%f%p + 2:)) <= infinity_level
            exit
         end if
         if (k == max_tenths) exit
         last = z
         call follow(h, t, tenth*t, least_step, z, is_done)
         if (.not. is_done) then
            z = last
            exit
         end if
         t = tenth*t
      end do
      e%is_singular = .not. is_done .or. k >= max_tenths
      e%x = z(:h%f%p + 1)
      e%y = z(h%f%p + 2:)
      if (is_done) return
      k = min(k, max_tenths)
      is_done = k >= least_tenths
      if (is_done) is_infinite = falls(finite(:k))
   end subroutine follow_path

   !> The values, one for each tenth of t, end as a power of t.
   pure logical function falls(finite)
      real(wp), intent(in) :: finite(:)

      associate (k => size(finite))
         falls = finite(k) <= infinity_level .or. log10(finite(k - 2)/finite(k)) >= 2.0_wp*least_power
      end associate
   end function falls

   !> Follows the path from `z` at `from` to `to`: the tangent by Runge and Kutta, Newton's correction; steps are
   !> divided down to the part `least` of the whole.
   subroutine follow(h, from, to, least, z, is_done)
      type(paths_t), intent(in) :: h
      real(wp), intent(in) :: from, to, least
      complex(wp), intent(inout) :: z(:)
      logical, intent(out) :: is_done
      complex(wp) :: next(size(z))
      real(wp) :: s, step, correction

      s = 0.0_wp
      step = max(first_step, least)
      do
         step = min(step, 1.0_wp - s)
         call predict(h, from + s*(to - from), step*(to - from), z, next, is_done)
         if (is_done) call correct(h, from + (s + step)*(to - from), next, correction, is_done)
         if (is_done) then
            z = next
            s = s + step
            if (s >= 1.0_wp - epsilon(1.0_wp)) return
            ! The error of a step goes with its fifth power.
            step = step*min(3.0_wp, max(0.5_wp, (h%careful*aim/max(correction, converged**2))**0.2_wp))
         else
            step = 0.4_wp*step
         end if
         if (step < least) exit
      end do
      is_done = .false.
   end subroutine follow

   !> A step of length `step` in t along the tangent, by Runge and Kutta's rule of fourth order.
   subroutine predict(h, t, step, z, next, is_done)
      type(paths_t), intent(in) :: h
      real(wp), intent(in) :: t, step
      complex(wp), intent(in) :: z(:)
      complex(wp), intent(out) :: next(:)
      logical, intent(out) :: is_done
      complex(wp), dimension(size(z)) :: k1, k2, k3, k4

      next = z
      call find_tangent(h, t, z, k1, is_done)
      if (is_done) call find_tangent(h, t + 0.5_wp*step, z + 0.5_wp*step*k1, k2, is_done)
      if (is_done) call find_tangent(h, t + 0.5_wp*step, z + 0.5_wp*step*k2, k3, is_done)
      if (is_done) call find_tangent(h, t + step, z + step*k3, k4, is_done)
      if (is_done) next = z + step*(k1 + 2.0_wp*(k2 + k3) + k4)/6.0_wp
      is_done = is_done .and. maxval(abs(next - z)) <= maxval(abs(z))
   end subroutine predict

   !> dz/dt at (`z`, `t`).
   subroutine find_tangent(h, t, z, tangent, is_done)
      type(paths_t), intent(in) :: h
      real(wp), intent(in) :: t
      complex(wp), intent(in) :: z(:)
      complex(wp), intent(out) :: tangent(:)
      logical, intent(out) :: is_done
      complex(wp) :: a(size(z), size(z)), r(size(z))
      integer :: pivots(size(z))
      logical :: is_singular

      tangent = 0.0_wp
      is_done = maxval(abs(z)) <= 1.0_wp/epsilon(1.0_wp)
      if (.not. is_done) return
      call assemble(h, t, z, a, r, tangent)
      call factor_complex(size(z), a, pivots, is_singular)
      is_done = .not. is_singular
      if (is_done) call solve_complex(size(z), a, pivots, tangent)
   end subroutine find_tangent

   !> Newton's method at `t`; `correction`: the first one, in parts of z. `is_done`: it was small, the others smaller.
   subroutine correct(h, t, z, correction, is_done)
      type(paths_t), intent(in) :: h
      real(wp), intent(in) :: t
      complex(wp), intent(inout) :: z(:)
      real(wp), intent(out) :: correction
      logical, intent(out) :: is_done
      complex(wp) :: a(size(z), size(z)), r(size(z)), slope(size(z))
      integer :: pivots(size(z)), k
      logical :: is_singular
      real(wp) :: now, before

      is_done = .false.
      before = 2.0_wp*h%careful*largest
      do k = 1, max_corrections
         call assemble(h, t, z, a, r, slope)
         call factor_complex(size(z), a, pivots, is_singular)
         if (is_singular) return
         call solve_complex(size(z), a, pivots, r)
         now = maxval(abs(r))/maxval(abs(z))
         if (k == 1) correction = now
         if (.not. now <= 0.5_wp*before) return
         z = z - r
         is_done = now <= converged
         if (is_done) return
         before = now
      end do
   end subroutine correct

   !> The residual `r` of the homotopy with its patches, its derivatives `a` by z, and by t with the opposite sign.
   subroutine assemble(h, t, z, a, r, slope)
      type(paths_t), intent(in) :: h
      real(wp), intent(in) :: t
      complex(wp), intent(in) :: z(:)
      complex(wp), intent(out) :: a(:, :), r(:), slope(:)
      complex(wp) :: left, right, g(2*h%f%p)
      integer :: j

      associate (p => h%f%p)
         associate (x => z(:p + 1), y => z(p + 2:))
            a(:2*p, :) = derivatives_at(h%f, x, y)
            do j = 1, 2*p
               ! The derivatives by y, times y, are the values.
               r(j) = sum(a(j, p + 2:)*y)
               a(j, :) = (1.0_wp - t)*a(j, :)
               left = sum(h%a(:, j)*x)
               right = sum(h%b(:, j)*y)
               g(j) = left*right
               a(j, :p + 1) = a(j, :p + 1) + t*right*h%a(:, j)
               a(j, p + 2:) = a(j, p + 2:) + t*left*h%b(:, j)
            end do
            slope(:2*p) = r(:2*p) - g
            r(:2*p) = (1.0_wp - t)*r(:2*p) + t*g
            a(2*p + 1:, :) = 0.0_wp
            a(2*p + 1, :p + 1) = h%patch(:, 1)
            a(2*p + 2, p + 2:) = h%patch(:, 2)
            r(2*p + 1) = sum(h%patch(:, 1)*x) - 1.0_wp
            r(2*p + 2) = sum(h%patch(:, 2)*y) - 1.0_wp
            slope(2*p + 1:) = 0.0_wp
         end associate
      end associate
   end subroutine assemble
end module homotopy
