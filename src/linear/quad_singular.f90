!> Singular values in real128, with the arguments and the results of LAPACK's routine of the same
!> name: columns are turned against each other, two at a time, until all are at right angles (Hestenes 1958).
module quad_singular
   use, intrinsic :: iso_fortran_env, only: qp => real128
   implicit none
   private
   public :: gesvd

   integer, parameter :: max_sweeps = 60

contains

   !> `a` (m, n) = `u` (m, m) diag(`s`) `vt` (n, n), `s` (min(m, n)) in falling order; `a` is lost. `jobu`
   !> and `jobvt` are A. `info` > 0: not all columns are at right angles. `work`(1): what `lwork` must be.
   pure subroutine gesvd(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork, info)
      character(1), intent(in) :: jobu, jobvt
      integer, intent(in) :: m, n, lda, ldu, ldvt, lwork
      real(qp), intent(inout) :: a(lda, *), work(*)
      real(qp), intent(out) :: s(*), u(ldu, *), vt(ldvt, *)
      integer, intent(out) :: info
      real(qp) :: left(max(m, n), max(m, n)), right(min(m, n), min(m, n))

      info = merge(0, -1, jobu == 'A' .and. jobvt == 'A' .and. lwork >= min(m, n))
      if (info < 0) return
      work(1) = real(min(m, n), qp)
      if (m >= n) then
         left(:, :n) = a(:m, :n)
      else
         left(:, :m) = transpose(a(:m, :n))
      end if
      call turn_columns(left(:, :min(m, n)), right, info)
      call sort_columns(left(:, :min(m, n)), right, s(:min(m, n)))
      call complete(left, s(:min(m, n)))
      if (m >= n) then
         u(:m, :m) = left
         vt(:n, :n) = transpose(right)
      else
         u(:m, :m) = right
         vt(:n, :n) = transpose(left)
      end if
   end subroutine gesvd

   !> Turns the columns of `w` (m, n), m >= n, until they are at right angles; `v` (n, n): the product of the
   !> turns.
   pure subroutine turn_columns(w, v, info)
      real(qp), intent(inout) :: w(:, :)
      real(qp), intent(out) :: v(:, :)
      integer, intent(out) :: info
      real(qp) :: noise, product_of, ratio, t
      integer :: i, j, k, sweep

      v = 0.0_qp
      do k = 1, size(v, 1)
         v(k, k) = 1.0_qp
      end do
      noise = rounding(w)
      do sweep = 1, max_sweeps
         info = 0
         do i = 1, size(w, 2) - 1
            do j = i + 1, size(w, 2)
               associate (a => norm2(w(:, i)), b => norm2(w(:, j)))
                  product_of = dot_product(w(:, i), w(:, j))
                  if (min(a, b) <= noise .or. abs(product_of) <= size(w, 1)*epsilon(a)*a*b) cycle
                  info = info + 1
                  ratio = (b - a)*(b + a)/(2.0_qp*product_of)
               end associate
               t = sign(1.0_qp, ratio)/(abs(ratio) + hypot(1.0_qp, ratio))
               call turn(w(:, i), w(:, j), t)
               call turn(v(:, i), v(:, j), t)
            end do
         end do
         if (info == 0) exit
      end do
   end subroutine turn_columns

   !> Columns of `w` no longer than this are rounding.
   pure real(qp) function rounding(w)
      real(qp), intent(in) :: w(:, :)

      rounding = size(w, 1)*epsilon(1.0_qp)*norm2(w)
   end function rounding

   !> Turns `x` and `y` by the angle of tangent `t`.
   pure subroutine turn(x, y, t)
      real(qp), intent(inout) :: x(:), y(:)
      real(qp), intent(in) :: t
      real(qp) :: c, before(size(x))

      c = 1.0_qp/hypot(1.0_qp, t)
      before = x
      x = c*(before - t*y)
      y = c*(t*before + y)
   end subroutine turn

   !> The lengths `s` of the columns of `w`, in falling order, the columns of `w` and `v` with them.
   pure subroutine sort_columns(w, v, s)
      real(qp), intent(inout) :: w(:, :), v(:, :)
      real(qp), intent(out) :: s(:)
      integer :: k, at

      s = norm2(w, dim=1)
      do k = 1, size(s)
         at = k - 1 + maxloc(s(k:), dim=1)
         s([k, at]) = s([at, k])
         w(:, [k, at]) = w(:, [at, k])
         v(:, [k, at]) = v(:, [at, k])
      end do
   end subroutine sort_columns

   !> Columns of length 1 at right angles from the first columns of `w`, which have the lengths `s`, and,
   !> where these are rounding or missing, from the axis that is nearest to being at right angles to all
   !> before.
   pure subroutine complete(w, s)
      real(qp), intent(inout) :: w(:, :)
      real(qp), intent(in) :: s(:)
      real(qp) :: noise
      integer :: k, i, twice

      noise = 0.0_qp
      if (size(s) > 0) noise = size(w, 1)*epsilon(1.0_qp)*norm2(s)
      do k = 1, size(w, 2)
         if (k <= size(s)) then
            if (s(k) > noise) then
               w(:, k) = w(:, k)/s(k)
               cycle
            end if
         end if
         i = minloc(sum(w(:, :k - 1)**2, dim=2), dim=1)
         w(:, k) = 0.0_qp
         w(i, k) = 1.0_qp
         do twice = 1, 2
            do i = 1, k - 1
               w(:, k) = w(:, k) - dot_product(w(:, i), w(:, k))*w(:, i)
            end do
            w(:, k) = w(:, k)/norm2(w(:, k))
         end do
      end do
   end subroutine complete
end module quad_singular
