!> Tests. The condition of a position and of its derivatives: for each coordinate y of each link the sum over all
!> numbers d of the deck, the drives' among them, of |dy/dd| |d|, and |y| itself. So much times eps is what a result
!> computed in double precision cannot be asked to be better than: each number of the deck is rounded to eps of itself
!> as it is read, and the result once more. Nothing in it is a norm or a bound, and nothing is the program's.
!>
!> The derivatives are differences in real128: one number is changed by `step` of itself, and Newton's method with the
!> matrix of the position as it was leads from there to the new one, its velocities and its accelerations.
module hard_condition
   use quad_jet, only: qp, jet_t, operator(+), operator(-), operator(*)
   use quad_lapack, only: getrf, getrs
   use mechanism, only: mechanism_t
   use scales, only: characteristic_length
   use closed_forms_dyads, only: motion_of
   use jet_closure, only: body_jet_t, numbers_of, set_grounds, closure_jets, closure_slopes
   use jet_drives, only: drive_jets, drive_changes
   implicit none
   private
   public :: condition_t, measure

   !> Rounding leaves 1e-34 over this, and a bend this over the distance to a dead point: both below a hundredth at
   !> 1e-12.
   real(qp), parameter :: step = 1.0e-20_qp
   !> With a fixed matrix an error of 1e-16 shrinks at 1e-12 from a dead point by 1e-4 at a time.
   integer, parameter :: few_steps = 6, many_steps = 14

   type :: condition_t
      logical :: exists = .false.                !< the position is not singular
      real(qp), allocatable :: of(:, :, :)       !< (3, links, 0:2) x, y, phi and derivatives, in the deck's units
   end type condition_t

   !> A (rows, unknowns) in triangular factors; where rows are too many, the normal equations. Unknown lengths in units
   !> of `body_vector`, each row divided by its largest number.
   type :: matrix_t
      logical :: regular = .false.
      real(qp) :: body_vector = 1.0_qp
      real(qp), allocatable :: row_size(:)
      real(qp), allocatable :: rows(:, :), factors(:, :)
      integer, allocatable :: pivot(:)
   end type matrix_t

contains

   !> The condition at `t`, near which the closed form has the links `start`.
   function measure(m, start, t) result(c)
      type(mechanism_t), intent(in) :: m
      type(body_jet_t), intent(in) :: start(:)
      real(qp), intent(in) :: t
      type(condition_t) :: c
      type(body_jet_t) :: b(size(start))
      type(jet_t) :: f(size(m%drives))
      real(qp), allocatable :: d(:)
      type(matrix_t) :: a

      allocate (c%of(3, size(start), 0:2))
      d = numbers_of(m)
      f = drive_jets(m, t)
      b = start
      call set_grounds(m, d, b)
      a = matrix_at(m, d, b)
      c%exists = a%regular
      if (.not. c%exists) return
      call solve(m, d, f, a, many_steps, b)
      c%of = abs(coordinates(b))
      call add_numbers(m, d, f, a, b, c%of)
      call add_drives(m, d, f, a, b, t, c%of)
   end function measure

   !> Adds what each of the numbers `d` does, the position being `b`.
   subroutine add_numbers(m, d, f, a, b, sums)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(jet_t), intent(in) :: f(:)
      type(matrix_t), intent(in) :: a
      type(body_jet_t), intent(in) :: b(:)
      real(qp), intent(inout) :: sums(:, :, 0:)
      real(qp) :: other(size(d))
      type(body_jet_t) :: moved(size(b))
      integer :: i

      other = d
      do i = 1, size(d)
         if (.not. abs(d(i)) > 0.0_qp) cycle
         other(i) = d(i)*(1.0_qp + step)
         moved = b
         call solve(m, other, f, a, few_steps, moved)
         sums = sums + abs(coordinates(moved) - coordinates(b))/step
         other(i) = d(i)
      end do
   end subroutine add_numbers

   !> Adds what each number of the drives does, the position being `b`.
   subroutine add_drives(m, d, f, a, b, t, sums)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:), t
      type(jet_t), intent(in) :: f(:)
      type(matrix_t), intent(in) :: a
      type(body_jet_t), intent(in) :: b(:)
      real(qp), intent(inout) :: sums(:, :, 0:)
      type(jet_t) :: other(size(f))
      type(jet_t), allocatable :: change(:)
      type(body_jet_t) :: moved(size(b))
      integer :: i, k

      do k = 1, size(f)
         change = drive_changes(m%drives(k), t)
         do i = 1, size(change)
            other = f
            other(k) = f(k) + step*change(i)
            moved = b
            call solve(m, d, other, a, few_steps, moved)
            sums = sums + abs(coordinates(moved) - coordinates(b))/step
         end do
      end do
   end subroutine add_drives

   !> x, y, phi of every link and their derivatives.
   function coordinates(b) result(y)
      type(body_jet_t), intent(in) :: b(:)
      real(qp) :: y(3, size(b), 0:2)
      integer :: i

      do i = 1, size(b)
         y(:, i, :) = motion_of(b(i))
      end do
   end function coordinates

   !> Newton's steps for positions, velocities and accelerations at once, all with the matrix `a`.
   subroutine solve(m, d, f, a, steps, b)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(jet_t), intent(in) :: f(:)
      type(matrix_t), intent(in) :: a
      integer, intent(in) :: steps
      type(body_jet_t), intent(inout) :: b(:)
      type(jet_t) :: r(size(a%rows, 1))
      real(qp) :: x(size(a%rows, 2), 3)
      integer :: k, i, n

      call set_grounds(m, d, b)
      do k = 1, steps
         r = closure_jets(m, d, b, f)
         x = solution(a, reshape([r%v, r%d, r%dd], [size(r), 3]))
         n = 0
         do i = 1, size(b)
            if (m%links(i)%ground) cycle
            b(i)%x = b(i)%x - a%body_vector*jet_t(x(n + 1, 1), x(n + 1, 2), x(n + 1, 3))
            b(i)%y = b(i)%y - a%body_vector*jet_t(x(n + 2, 1), x(n + 2, 2), x(n + 2, 3))
            b(i)%phi = b(i)%phi - jet_t(x(n + 3, 1), x(n + 3, 2), x(n + 3, 3))
            n = n + 3
         end do
      end do
   end subroutine solve

   !> The Jacobian at the position `b`, factored.
   function matrix_at(m, d, b) result(a)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(body_jet_t), intent(in) :: b(:)
      type(matrix_t) :: a
      real(qp), allocatable :: largest(:)
      integer :: k, n, info

      a%body_vector = characteristic_length(m)
      a%rows = closure_slopes(m, d, b)
      a%rows(:, 1::3) = a%body_vector*a%rows(:, 1::3)
      a%rows(:, 2::3) = a%body_vector*a%rows(:, 2::3)
      n = size(a%rows, 2)
      a%row_size = maxval(abs(a%rows), dim=2)
      a%rows = a%rows/spread(a%row_size, 2, n)
      a%factors = a%rows
      if (size(a%rows, 1) > n) a%factors = matmul(transpose(a%rows), a%rows)
      largest = maxval(abs(a%factors), dim=1)
      allocate (a%pivot(n))
      call getrf(n, n, a%factors, n, a%pivot, info)
      a%regular = all([(abs(a%factors(k, k)) > 1.0e-26_qp*largest(k), k=1, n)])
   end function matrix_at

   !> The solutions of rows x = `right` (rows, any number), or those with the least squares.
   function solution(a, right) result(x)
      type(matrix_t), intent(in) :: a
      real(qp), intent(in) :: right(:, :)
      real(qp) :: x(size(a%factors, 2), size(right, 2)), scaled(size(right, 1), size(right, 2))
      integer :: info

      scaled = right/spread(a%row_size, 2, size(right, 2))
      if (size(right, 1) > size(x, 1)) then
         x = matmul(transpose(a%rows), scaled)
      else
         x = scaled
      end if
      call getrs('N', size(x, 1), size(x, 2), a%factors, size(x, 1), a%pivot, x, size(x, 1), info)
   end function solution
end module hard_condition
