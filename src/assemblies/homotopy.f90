!> All solutions of a bilinear system f(x, y) = 0 by continuation. The paths come from the solutions of g = 0, in which
!> each equation is the product of a linear form in x and one in y, along
!>
!>    h(x, y, t) = (1 - t) f(x, y) + t g(x, y),   t from 1 to 0.
!>
!> With random complex forms no two paths meet before t = 0. Each isolated solution is the end of a path, and each set
!> of others has the end of one (Morgan and Sommese, Appl. Math. Comput. 24 (1987) 101-113; Sommese and Wampler, The
!> Numerical Solution of Systems of Polynomials, 2005). Each run has equal random numbers. Coordinates are homogeneous,
!> x . u = 1 and y . v = 1 with random u and v: paths to infinity have ends like other paths.
module homotopy
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use plane_vectors, only: pi
   use lapack, only: zgetf2, zgetrs
   use bilinear, only: bilinear_t, path_start_t, path_end_t, ends_t, finiteness, infinity_level
   implicit none
   private
   public :: follow_paths

   !> The paths of h = f + t more from the solutions of g = f + more, in the coordinates z: x and y without their first
   !> coordinates, which the chart of the start gives.
   type :: paths_t
      integer :: p = 0                                      !< unknowns of each group
      complex(dp), allocatable :: f(:, :, :), more(:, :, :) !< (0:p, 0:p, 2p) coefficients of the equations
      real(dp) :: t = -1.0_dp                               !< the last t for which h was found
      complex(dp), allocatable :: h(:, :, :)                !< (0:p, 0:p, 2p) at this t
   end type paths_t

   !> The correction of a prediction at which steps aim, in parts of z.
   real(dp), parameter :: aimed_correction = 1.0e-5_dp
   !> The largest correction of a prediction, in parts of z: paths that are further apart are not mistaken for one
   !> another. Paths that almost meet at some t are apart by about the root of the least step there. Therefore,
   !> below the least step by the first tenth, this limit falls with the root of the step.
   real(dp), parameter :: max_prediction_error = 1.0e-3_dp
   !> Corrections below this part of z are rounding. On the way to an end, a correction below the root of this part is
   !> the last, since Newton's method leaves the square: near a singular end rounding keeps corrections above a smaller
   !> part.
   real(dp), parameter :: path_rounding = 1.0e-11_dp
   integer, parameter :: max_corrections = 4   !< each squares the one before: 1E-3 becomes rounding in three
   !> From `t_near_end` on t falls by tenths, and from each tenth the end is tried in a few steps. A path that does not
   !> reach its end in this way has a singular end, unless a neighbour is nearer than about the root of the last t.
   real(dp), parameter :: tenth = 0.1_dp, t_near_end = tenth
   !> The first step and the least, as parts of the way: from t = 1 to `t_near_end`, by a tenth, and to the end. In the
   !> first `least_tenths` tenths the least step is the one to `t_near_end`: a path that fails there is lost.
   real(dp), parameter :: steps_near_end(2) = [0.02_dp, 1.0e-9_dp], steps_by_tenth(2) = [0.3_dp, 1.0e-5_dp]
   real(dp), parameter :: steps_to_end(2) = 0.3_dp
   !> Tenths by which t falls at most: three digits are left above rounding.
   integer, parameter :: max_tenths = nint(-log10(epsilon(1.0_dp))) - 3
   !> x . u of a path to infinity falls with t at this power or more: 1 over the number of paths that meet there.
   real(dp), parameter :: least_power = 0.04_dp
   !> Tenths by which t must fall before a path that fails is classified as infinite or singular.
   integer, parameter :: least_tenths = 4
   !> Fewer tenths are enough if `finiteness` is below this, and falls with this power of t or more.
   real(dp), parameter :: near_infinity = 1.0e-3_dp, sure_power = 0.5_dp
   !> Regular ends that differ by less, in parts of z, are one: half of all digits.
   real(dp), parameter :: same_end_tolerance = sqrt(epsilon(1.0_dp))

contains

   !> Finds the ends of all paths of a system. Paths from a given start are tried first. If there is no start of this p,
   !> or one of its paths fails, all paths begin at random forms and leave a start: from it the paths of a similar
   !> system are short.
   subroutine follow_paths(bilinear, start, ends)
      type(bilinear_t), intent(in) :: bilinear   !< the system, p from 1
      !> The given start. After paths from random forms: their points at t = t_near_end, if all come so far.
      type(path_start_t), allocatable, intent(inout) :: start
      type(ends_t), intent(out) :: ends          !< with the number of paths that failed
      type(path_start_t) :: own
      logical :: is_done

      is_done = .false.
      if (allocated(start)) is_done = start%p == bilinear%p
      if (is_done) call follow_all(bilinear, start, ends)
      if (is_done) is_done = ends%failed == 0
      if (is_done) return
      call make_start(bilinear%p, own)
      call follow_all(bilinear, own, ends, start)
   end subroutine follow_paths

   !> Makes a start of paths from random forms, with its C(2p, p) solutions. Solution number k takes the k-th choice of
   !> half of the equations: at it their forms in x are zero, and the forms in y of the other half.
   subroutine make_start(group_size, start)
      integer, intent(in) :: group_size      !< p, unknowns of each group
      type(path_start_t), intent(out) :: start   !< with charts, equations and solutions
      complex(dp) :: a(0:group_size, 2*group_size), b(0:group_size, 2*group_size)
      integer :: seed, chosen(group_size), paths, j, k

      start%p = group_size
      paths = 1
      do k = 1, group_size
         paths = paths*(group_size + k)/k
      end do
      allocate (start%chart(group_size, 2), start%c(0:group_size, 0:group_size, 2*group_size), &
         start%z(2*group_size, paths))

      seed = 1987
      do j = 1, 2*group_size
         do k = 0, group_size
            a(k, j) = on_circle(seed)
            b(k, j) = on_circle(seed)
         end do
         do k = 0, group_size
            start%c(:, k, j) = a(:, j)*b(k, j)
         end do
      end do
      do k = 1, group_size
         start%chart(k, 1) = on_circle(seed)
         start%chart(k, 2) = on_circle(seed)
      end do

      chosen = [(k, k=1, group_size)]
      do k = 1, size(start%z, 2)
         start%z(:group_size, k) = common_zero(a(:, chosen))
         start%z(group_size + 1:, k) = common_zero(b(:, pack([(j, j=1, 2*group_size)], &
            [(all(chosen /= j), j=1, 2*group_size)])))
         call choose_next(chosen, 2*group_size)
      end do
   end subroutine make_start

   !> Gives a random complex number of size 1 (Park and Miller, Comm. ACM 31 (1988) 1192-1201).
   complex(dp) function on_circle(seed) result(z)
      integer, intent(inout) :: seed   !< 1 to 2^31 - 2; then the next seed

      ! 16807 seed modulo 2^31 - 1 in the range of integers, by Schrage's decomposition.
      seed = 16807*mod(seed, 127773) - 2836*(seed/127773)
      if (seed < 0) seed = seed + huge(seed)
      z = exp(cmplx(0.0_dp, 2.0_dp*real(pi, dp)*(real(seed, dp)/real(huge(seed), dp)), dp))
   end function on_circle

   !> Finds the point (p) at which p random linear forms in p unknowns are zero.
   function common_zero(forms) result(z)
      complex(dp), intent(in) :: forms(0:, :)   !< (0:p, p) of each form the constant and the coefficients
      complex(dp) :: z(size(forms, 2)), a(size(forms, 2), size(forms, 2)), x(size(forms, 2), 1)
      logical :: is_regular

      a = transpose(forms(1:, :))
      x(:, 1) = -forms(0, :)
      call solve(a, x, is_regular)
      z = x(:, 1)
   end function common_zero

   !> Replaces a choice of numbers from 1 to n by the next choice in lexicographic order. The last choice stays.
   subroutine choose_next(chosen, n)
      integer, intent(inout) :: chosen(:)   !< (any number) different numbers in increasing order
      integer, intent(in) :: n              !< the largest number
      integer :: k, j

      do k = size(chosen), 1, -1
         if (chosen(k) == n - size(chosen) + k) cycle
         chosen(k:) = [(chosen(k) + j, j=1, size(chosen) - k + 1)]
         return
      end do
   end subroutine choose_next

   !> Follows every path of a system from a start. If two paths come to one regular end, one of them has jumped to the
   !> other on the way: the second counts as failed.
   subroutine follow_all(bilinear, start, ends, near)
      type(bilinear_t), intent(in) :: bilinear   !< the system whose solutions are found
      type(path_start_t), intent(in) :: start   !< for the system's p
      type(ends_t), intent(out) :: ends         !< the finite ends, and counts
      !> The points of the paths at t = t_near_end as a start, if all come so far; otherwise it stays.
      type(path_start_t), allocatable, intent(inout), optional :: near
      type(paths_t) :: h
      complex(dp) :: z(2*bilinear%p, size(start%z, 2))
      real(dp) :: step
      type(path_end_t) :: list(size(start%z, 2))
      logical :: is_done, is_infinite, is_twin(size(start%z, 2)), is_whole
      integer :: count_of, k, j

      h%p = bilinear%p
      allocate (h%f(0:bilinear%p, 0:bilinear%p, 2*bilinear%p), h%more(0:bilinear%p, 0:bilinear%p, 2*bilinear%p), &
         h%h(0:bilinear%p, 0:bilinear%p, 2*bilinear%p), source=bilinear%c)
      do k = 1, bilinear%p
         h%f(k, :, :) = h%f(k, :, :) + start%chart(k, 1)*h%f(0, :, :)
      end do
      do k = 1, bilinear%p
         h%f(:, k, :) = h%f(:, k, :) + start%chart(k, 2)*h%f(:, 0, :)
      end do
      h%more(:, :, :) = start%c - h%f

      ends%paths = size(list)
      z = start%z
      is_whole = .true.
      count_of = 0
      do k = 1, size(list)
         associate (e => list(count_of + 1))
            step = steps_near_end(1)
            call follow(h, 1.0_dp, t_near_end, step, steps_near_end(2), z(:, k), is_done)
            is_whole = is_whole .and. is_done
            if (is_done) call follow_to_end(bilinear, h, start%chart, z(:, k), e, is_infinite, is_done)
         end associate
         if (.not. is_done) ends%failed = ends%failed + 1
         if (is_done .and. is_infinite) ends%infinite = ends%infinite + 1
         if (is_done .and. .not. is_infinite) count_of = count_of + 1
      end do
      if (present(near) .and. is_whole) near = path_start_t(bilinear%p, start%chart, h%f + t_near_end*h%more, z)

      is_twin = .false.
      do k = 2, count_of
         do j = 1, k - 1
            if (list(k)%is_singular .or. list(j)%is_singular .or. is_twin(j)) cycle
            is_twin(k) = is_twin(k) .or. all(abs(list(k)%x - list(j)%x) <= same_end_tolerance*maxval(abs(list(k)%x))) &
               .and. all(abs(list(k)%y - list(j)%y) <= same_end_tolerance*maxval(abs(list(k)%y)))
         end do
      end do
      ends%failed = ends%failed + count(is_twin)
      ends%list = pack(list(:count_of), .not. is_twin(:count_of))
   end subroutine follow_all

   !> Follows a path from t = t_near_end to its end, which may be finite, singular or at infinity. The point of a
   !> singular end, or of one at infinity, is the last point that was reached.
   subroutine follow_to_end(bilinear, paths, chart, start, ending, is_infinite, is_done)
      type(bilinear_t), intent(in) :: bilinear   !< the system whose solutions are found
      type(paths_t), intent(inout) :: paths     !< of the system
      complex(dp), intent(in) :: chart(:, :)    !< (p, 2) of the start
      complex(dp), intent(in) :: start(:)       !< (2p) z at t = t_near_end
      type(path_end_t), intent(inout) :: ending   !< the end
      logical, intent(out) :: is_infinite       !< the end is at infinity
      logical, intent(out) :: is_done           !< the end was classified; otherwise the path has failed
      complex(dp), dimension(size(start)) :: z, last
      real(dp) :: t, step, try, finite(0:max_tenths)
      integer :: k

      t = t_near_end
      step = steps_by_tenth(1)
      z = start
      do k = 0, max_tenths
         call record_end(z)
         finite(k) = finiteness(bilinear, ending%x, ending%y)
         is_done = .false.
         if (k > least_tenths .and. finite(k) <= infinity_level) then
            if (power_of(finite(:k)) >= sure_power) exit
         end if

         last = z
         try = steps_to_end(1)
         call follow(paths, t, 0.0_dp, try, steps_to_end(2), last, is_done)
         if (is_done .or. k == max_tenths) exit
         last = z
         call follow(paths, t, tenth*t, step, merge(steps_near_end(2), steps_by_tenth(2), k < least_tenths), last, &
            is_done)
         if (.not. is_done) exit
         z = last
         t = tenth*t
      end do

      ending%is_singular = .not. is_done .or. k >= max_tenths
      if (is_done) then
         call record_end(last)
         is_infinite = finiteness(bilinear, ending%x, ending%y) <= infinity_level
      else
         call record_end(z)
         k = min(k, max_tenths)
         is_infinite = falls(finite(:k))
         is_done = is_infinite .or. k >= least_tenths
      end if

   contains

      !> Sets the end to a point, in homogeneous coordinates.
      subroutine record_end(root)
         complex(dp), intent(in) :: root(:)   !< (2p) z

         ending%x = [1.0_dp + sum(chart(:, 1)*root(:paths%p)), root(:paths%p)]
         ending%y = [1.0_dp + sum(chart(:, 2)*root(paths%p + 1:)), root(paths%p + 1:)]
      end subroutine record_end
   end subroutine follow_to_end

   !> Tells whether a path goes to infinity: its finiteness falls as a power of t. A few values tell this only if they
   !> fall fast; fewer than three never do.
   pure logical function falls(finite)
      real(dp), intent(in) :: finite(:)      !< (any number) the finiteness of the path, one for each tenth of t
      real(dp) :: power

      associate (k => size(finite))
         falls = .false.
         if (k < 3) return
         power = power_of(finite)
         falls = finite(k) <= infinity_level .or. (k > least_tenths .and. power >= least_power) &
            .or. (finite(k) <= near_infinity .and. power >= sure_power)
      end associate
   end function falls

   !> Gives the power of t with which the finiteness of a path fell in the last two tenths.
   pure real(dp) function power_of(finite)
      real(dp), intent(in) :: finite(:)      !< (3 or more) the finiteness, one for each tenth of t

      power_of = 0.5_dp*log10(finite(size(finite) - 2)/finite(size(finite)))
   end function power_of

   !> Follows a path between two values of t. A step is predicted by Runge and Kutta's rule and corrected by Newton's
   !> method; a step that fails is made shorter, down to the least.
   subroutine follow(paths, from, to, step, least, point, is_done)
      type(paths_t), intent(inout) :: paths   !< of the system
      real(dp), intent(in) :: from, to       !< the two values of t
      real(dp), intent(inout) :: step        !< the first step, afterwards the step for going on, as parts of the way
      real(dp), intent(in) :: least          !< the least step, as a part of the way
      complex(dp), intent(inout) :: point(:) !< (2p) z at `from`; then at `to`, or the last point that was reached
      logical, intent(out) :: is_done        !< `to` was reached
      complex(dp), dimension(size(point)) :: tangent, next, next_tangent
      real(dp) :: s, h, correction, t, rate

      s = 0.0_dp
      call correct(paths, from, point, tangent, correction, is_done)
      if (.not. is_done) return

      do
         h = min(step, 1.0_dp - s)
         call predict(paths, from, to, s, h, point, tangent, next, is_done)
         call find_t(from, to, s + h, t, rate)
         if (is_done) call correct(paths, t, next, next_tangent, correction, is_done)
         if (is_done) is_done = correction <= max_prediction_error*sqrt(h/steps_by_tenth(2))

         if (is_done) then
            point = next
            tangent = next_tangent
            s = s + h
            if (s >= 1.0_dp - epsilon(1.0_dp)) return
            ! The error of a step goes with the fifth power of its length.
            step = h*min(3.0_dp, max(0.5_dp, (aimed_correction/max(correction, epsilon(1.0_dp)))**0.2_dp))
         else
            step = 0.4_dp*h
         end if
         if (step < least) exit
      end do
      is_done = .false.
   end subroutine follow

   !> Finds t at a part of the way between two of its values. On the way by a tenth t falls by equal factors, since z
   !> goes with a power of t near a singular end; otherwise evenly.
   pure subroutine find_t(from, to, covered, t, rate)
      real(dp), intent(in) :: from, to       !< the two values of t
      real(dp), intent(in) :: covered        !< part of the way, 0 to 1
      real(dp), intent(out) :: t             !< the value there
      real(dp), intent(out) :: rate          !< the derivative of t by the part of the way

      rate = to - from
      t = from + covered*rate
      if (from > t_near_end .or. .not. to > 0.0_dp) return
      t = from*(to/from)**covered
      rate = t*log(to/from)
   end subroutine find_t

   !> Predicts z after a step by Runge and Kutta's rule of fourth order. The prediction fails if a tangent does not
   !> exist, or if z changes by more than its size.
   subroutine predict(paths, from, to, covered, step, point, tangent, next, is_done)
      type(paths_t), intent(inout) :: paths   !< of the system
      real(dp), intent(in) :: from, to       !< the two values of t of the way
      real(dp), intent(in) :: covered        !< part of the way before the step
      real(dp), intent(in) :: step           !< part of the way
      complex(dp), intent(in) :: point(:)    !< (2p) z before the step
      complex(dp), intent(in) :: tangent(:)  !< (2p) the derivative of z by t there
      complex(dp), intent(out) :: next(:)    !< (2p) z after the step; of no use if the prediction fails
      logical, intent(out) :: is_done        !< the prediction has not failed
      !> The rule's stages: parts of the step at which tangents are taken, and the weights of the tangents.
      real(dp), parameter :: stage_parts(4) = [0.0_dp, 0.5_dp, 0.5_dp, 1.0_dp]
      real(dp), parameter :: stage_weights(4) = [1.0_dp, 2.0_dp, 2.0_dp, 1.0_dp]/6.0_dp
      complex(dp) :: a(size(point), size(point)), x(size(point)), r(size(point)), slope(size(point), 1)
      real(dp) :: t, rate
      integer :: k

      call find_t(from, to, covered, t, rate)
      slope(:, 1) = rate*tangent
      next = point + stage_weights(1)*step*slope(:, 1)
      do k = 2, size(stage_parts)
         x = point + stage_parts(k)*step*slope(:, 1)
         is_done = size_of(x) <= 1.0_dp/epsilon(1.0_dp)
         if (.not. is_done) return
         call find_t(from, to, covered + stage_parts(k)*step, t, rate)
         call assemble(paths, t, x, a, r, slope(:, 1))
         call solve(a, slope, is_done)
         if (.not. is_done) return
         slope = rate*slope
         next = next + stage_weights(k)*step*slope(:, 1)
      end do
      is_done = size_of(next - point) <= size_of(point)
   end subroutine predict

   !> Corrects a point of a path by Newton's method. The correction fails if the first step is above
   !> `max_prediction_error`, a later step is not at most half of the one before, or `max_corrections` steps are not
   !> enough.
   subroutine correct(paths, t, point, tangent, correction, is_done)
      type(paths_t), intent(inout) :: paths   !< of the system
      real(dp), intent(in) :: t              !< the t of the point
      complex(dp), intent(inout) :: point(:) !< (2p) z; of no use if the correction fails
      complex(dp), intent(out) :: tangent(:) !< (2p) the derivative of z by t, before the last step
      real(dp), intent(out) :: correction    !< the first step, as a part of the point's size
      logical, intent(out) :: is_done        !< the correction has not failed
      complex(dp) :: a(size(point), size(point)), r(size(point), 2)
      integer :: k
      real(dp) :: now, before

      before = 2.0_dp*max_prediction_error
      do k = 1, max_corrections
         call assemble(paths, t, point, a, r(:, 1), r(:, 2))
         call solve(a, r, is_done)
         if (.not. is_done) return
         tangent = r(:, 2)
         now = size_of(r(:, 1))/size_of(point)
         if (k == 1) correction = now
         is_done = now <= 0.5_dp*before
         if (.not. is_done) return
         point = point - r(:, 1)
         is_done = now <= merge(sqrt(path_rounding), path_rounding, t > 0.0_dp)
         if (is_done) return
         before = now
      end do
   end subroutine correct

   !> Solves complex linear equations for several right-hand sides.
   subroutine solve(a, sides, is_done)
      complex(dp), intent(inout) :: a(:, :)  !< (n, n) the matrix, then its factors
      complex(dp), intent(inout) :: sides(:, :)   !< (n, any number) right-hand sides, then solutions if there are any
      logical, intent(out) :: is_done        !< the matrix is not singular
      integer :: pivots(size(sides, 1)), info

      associate (n => size(sides, 1))
         call zgetf2(n, n, a, n, pivots, info)
         is_done = info == 0
         if (is_done) call zgetrs('N', n, size(sides, 2), a, n, pivots, sides, n, info)
      end associate
   end subroutine solve

   !> Gives the size of the largest real or imaginary part of a point.
   pure real(dp) function size_of(point)
      complex(dp), intent(in) :: point(:)    !< (2p) z
      integer :: k

      size_of = 0.0_dp
      do k = 1, size(point)
         size_of = max(size_of, abs(real(point(k))), abs(aimag(point(k))))
      end do
   end function size_of

   !> Finds the residual of the homotopy at a point, and its derivatives. Most calls have the t of the call before:
   !> `paths` keeps the coefficients.
   subroutine assemble(paths, t, point, a, residual, slope)
      type(paths_t), intent(inout) :: paths   !< of the system
      real(dp), intent(in) :: t              !< the t of the point
      complex(dp), intent(in) :: point(:)    !< (2p) z
      complex(dp), intent(out) :: a(:, :)    !< (2p, 2p) the Jacobian by z
      complex(dp), intent(out) :: residual(:)   !< (2p) the values of the equations
      complex(dp), intent(out) :: slope(:)   !< (2p) minus the derivative by t
      complex(dp), dimension(0:paths%p) :: x, y, by_x
      complex(dp) :: by_y, along
      integer :: i, j, k

      if (abs(t - paths%t) > 0.0_dp) paths%h(:, :, :) = paths%f + t*paths%more
      paths%t = t
      associate (p => paths%p)
         x = [(1.0_dp, 0.0_dp), point(:p)]
         y = [(1.0_dp, 0.0_dp), point(p + 1:)]
         residual = 0.0_dp
         slope = 0.0_dp

         do j = 1, 2*p
            by_x = 0.0_dp
            do k = 0, p
               by_y = 0.0_dp
               along = 0.0_dp
               do i = 0, p
                  by_x(i) = by_x(i) + paths%h(i, k, j)*y(k)
                  by_y = by_y + x(i)*paths%h(i, k, j)
                  along = along + x(i)*paths%more(i, k, j)
               end do
               if (k > 0) a(j, p + k) = by_y
               residual(j) = residual(j) + by_y*y(k)
               slope(j) = slope(j) - along*y(k)
            end do
            a(j, :p) = by_x(1:)
         end do
      end associate
   end subroutine assemble
end module homotopy
