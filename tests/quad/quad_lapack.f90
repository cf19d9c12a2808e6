!> LAPACK's routines in real128, with the arguments and the results of those of the same names: square systems by
!> Gauss's elimination with partial pivoting, P A = L U; least squares by Householder's reflections I - tau v v^T,
!> v(1) = 1; singular values by turning columns against each other until all are at right angles (Hestenes 1958). Only
!> what is asked of them here; `info` < 0 for anything else.
module quad_lapack
   use, intrinsic :: iso_fortran_env, only: qp => real128
   implicit none
   private
   public :: gesv, getrf, getrs, lacn2, ptsv, geqrf, ormqr, trtrs, gesvd

   integer, parameter :: max_sweeps = 60

contains

   !> Solves `a` x = `b`; `a` (n, n) becomes its factors, `b` (n, nrhs) the solutions. `info` > 0: that pivot is zero.
   pure subroutine gesv(n, nrhs, a, lda, ipiv, b, ldb, info)
      integer, intent(in) :: n, nrhs, lda, ldb
      real(qp), intent(inout) :: a(lda, *), b(ldb, *)
      integer, intent(out) :: ipiv(*), info

      call getrf(n, n, a, lda, ipiv, info)
      if (info == 0) call getrs('N', n, nrhs, a, lda, ipiv, b, ldb, info)
   end subroutine gesv

   !> Factors `a` (m, n), m >= n, in place, row k exchanged with row `ipiv`(k).
   pure subroutine getrf(m, n, a, lda, ipiv, info)
      integer, intent(in) :: m, n, lda
      real(qp), intent(inout) :: a(lda, *)
      integer, intent(out) :: ipiv(*), info
      integer :: j, k

      info = merge(0, -1, m >= n)
      if (info < 0) return
      do k = 1, n
         ipiv(k) = k - 1 + maxloc(abs(a(k:m, k)), dim=1)
         if (abs(a(ipiv(k), k)) <= 0.0_qp) then
            if (info == 0) info = k
            cycle
         end if
         if (ipiv(k) /= k) a([k, ipiv(k)], :n) = a([ipiv(k), k], :n)
         a(k + 1:m, k) = a(k + 1:m, k)/a(k, k)
         do j = k + 1, n
            a(k + 1:m, j) = a(k + 1:m, j) - a(k, j)*a(k + 1:m, k)
         end do
      end do
   end subroutine getrf

   !> Solves for the columns of `b` (n, nrhs) by the factors; `trans` is N, or T for the matrix transposed.
   pure subroutine getrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
      character(1), intent(in) :: trans
      integer, intent(in) :: n, nrhs, lda, ldb, ipiv(*)
      real(qp), intent(in) :: a(lda, *)
      real(qp), intent(inout) :: b(ldb, *)
      integer, intent(out) :: info
      integer :: j, k

      info = merge(0, -1, any(trans == ['N', 'T']))
      if (info < 0) return
      do j = 1, nrhs
         if (trans == 'T') then
            call solve_transposed(n, a, lda, ipiv, b(1:n, j))
            cycle
         end if
         do k = 1, n
            if (ipiv(k) /= k) b([k, ipiv(k)], j) = b([ipiv(k), k], j)
         end do
         do k = 1, n
            b(k + 1:n, j) = b(k + 1:n, j) - b(k, j)*a(k + 1:n, k)
         end do
         do k = n, 1, -1
            b(k, j) = b(k, j)/a(k, k)
            b(:k - 1, j) = b(:k - 1, j) - b(k, j)*a(:k - 1, k)
         end do
      end do
   end subroutine getrs

   !> Solves for one right-hand side `b` (n) with the matrix transposed.
   pure subroutine solve_transposed(n, a, lda, ipiv, b)
      integer, intent(in) :: n, lda, ipiv(*)
      real(qp), intent(in) :: a(lda, *)
      real(qp), intent(inout) :: b(n)
      integer :: k

      do k = 1, n
         b(k) = (b(k) - dot_product(a(:k - 1, k), b(:k - 1)))/a(k, k)
      end do
      do k = n, 1, -1
         b(k) = b(k) - dot_product(a(k + 1:n, k), b(k + 1:))
      end do
      do k = n, 1, -1
         if (ipiv(k) /= k) b([k, ipiv(k)]) = b([ipiv(k), k])
      end do
   end subroutine solve_transposed

   !> The 1-norm of a matrix that only its products are known of, exactly, column by column: begun with `kase` = 0,
   !> it asks for A `x` in the place of `x` (n) as long as it returns `kase` = 1; `kase` = 0: `est` is the norm. `v`
   !> (n): the column of the largest sum.
   pure subroutine lacn2(n, v, x, isgn, est, kase, isave)
      integer, intent(in) :: n
      real(qp), intent(inout) :: v(*), x(*), est
      integer, intent(inout) :: isgn(*), kase, isave(3)

      if (kase == 0) then
         isave = 0
         isgn(:n) = 0
         est = -1.0_qp
      else if (sum(abs(x(:n))) > est) then
         est = sum(abs(x(:n)))
         v(:n) = x(:n)
      end if
      isave(1) = isave(1) + 1
      kase = merge(1, 0, isave(1) <= n)
      if (kase == 0) return
      x(:n) = 0.0_qp
      x(isave(1)) = 1.0_qp
   end subroutine lacn2

   !> Solves the symmetric positive definite tridiagonal system with diagonal `d` (n) and off-diagonal `e` (n - 1),
   !> which become its factors L D L^T; `b` (n, nrhs) becomes the solutions. `info` > 0: not positive definite.
   pure subroutine ptsv(n, nrhs, d, e, b, ldb, info)
      integer, intent(in) :: n, nrhs, ldb
      real(qp), intent(inout) :: d(*), e(*), b(ldb, *)
      integer, intent(out) :: info
      real(qp) :: ratio
      integer :: k

      info = 0
      do k = 1, n
         if (.not. d(k) > 0.0_qp) info = k
         if (info > 0) return
         if (k == n) exit
         ratio = e(k)/d(k)
         d(k + 1) = d(k + 1) - ratio*e(k)
         e(k) = ratio
         b(k + 1, :nrhs) = b(k + 1, :nrhs) - ratio*b(k, :nrhs)
      end do
      do k = n, 1, -1
         b(k, :nrhs) = b(k, :nrhs)/d(k)
         if (k < n) b(k, :nrhs) = b(k, :nrhs) - e(k)*b(k + 1, :nrhs)
      end do
   end subroutine ptsv

   !> `a` (m, n), m >= n, becomes R on and above its diagonal and the vectors v below it; `tau` (n).
   pure subroutine geqrf(m, n, a, lda, tau, work, lwork, info)
      integer, intent(in) :: m, n, lda, lwork
      real(qp), intent(inout) :: a(lda, *), work(*)
      real(qp), intent(out) :: tau(*)
      integer, intent(out) :: info
      real(qp) :: diagonal
      integer :: j, k

      info = merge(0, -7, m >= n .and. lwork >= n)
      if (info < 0) return
      do k = 1, n
         tau(k) = 0.0_qp
         if (k == m) exit
         if (maxval(abs(a(k + 1:m, k))) <= 0.0_qp) cycle
         diagonal = -sign(norm2(a(k:m, k)), a(k, k))
         tau(k) = (diagonal - a(k, k))/diagonal
         a(k + 1:m, k) = a(k + 1:m, k)/(a(k, k) - diagonal)
         a(k, k) = diagonal
         do j = k + 1, n
            work(j) = a(k, j) + dot_product(a(k + 1:m, k), a(k + 1:m, j))
            a(k, j) = a(k, j) - tau(k)*work(j)
            a(k + 1:m, j) = a(k + 1:m, j) - tau(k)*work(j)*a(k + 1:m, k)
         end do
      end do
   end subroutine geqrf

   !> Q^T `c`, `c` (m, n), with the first `k` reflections of `geqrf`; `side` is L, `trans` T.
   pure subroutine ormqr(side, trans, m, n, k, a, lda, tau, c, ldc, work, lwork, info)
      character(1), intent(in) :: side, trans
      integer, intent(in) :: m, n, k, lda, ldc, lwork
      real(qp), intent(in) :: a(lda, *), tau(*)
      real(qp), intent(inout) :: c(ldc, *), work(*)
      integer, intent(out) :: info
      integer :: i, j

      info = merge(0, -1, side == 'L' .and. trans == 'T' .and. lwork >= n)
      if (info < 0) return
      do i = 1, k
         do j = 1, n
            work(j) = c(i, j) + dot_product(a(i + 1:m, i), c(i + 1:m, j))
            c(i, j) = c(i, j) - tau(i)*work(j)
            c(i + 1:m, j) = c(i + 1:m, j) - tau(i)*work(j)*a(i + 1:m, i)
         end do
      end do
   end subroutine ormqr

   !> Solves R x = `b` (n, nrhs), or R^T x = `b`: `trans` T; `uplo` is U, `diag` N.
   !> `info` > 0: that diagonal entry is zero.
   pure subroutine trtrs(uplo, trans, diag, n, nrhs, a, lda, b, ldb, info)
      character(1), intent(in) :: uplo, trans, diag
      integer, intent(in) :: n, nrhs, lda, ldb
      real(qp), intent(in) :: a(lda, *)
      real(qp), intent(inout) :: b(ldb, *)
      integer, intent(out) :: info
      integer :: j, k

      info = merge(0, -1, uplo == 'U' .and. any(trans == ['N', 'T']) .and. diag == 'N')
      if (info < 0) return
      do k = 1, n
         if (abs(a(k, k)) <= 0.0_qp) info = k
         if (info > 0) return
      end do
      do j = 1, nrhs
         if (trans == 'T') then
            do k = 1, n
               b(k, j) = (b(k, j) - dot_product(a(:k - 1, k), b(:k - 1, j)))/a(k, k)
            end do
            cycle
         end if
         do k = n, 1, -1
            b(k, j) = b(k, j)/a(k, k)
            b(:k - 1, j) = b(:k - 1, j) - b(k, j)*a(:k - 1, k)
         end do
      end do
   end subroutine trtrs

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

   !> Turns the columns of `w` (m, n), m >= n, until they are at right angles; `v` (n, n): the product of the turns.
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

   !> Columns of length 1 at right angles from the first columns of `w`, which have the lengths `s`, and, where these
   !> are rounding or missing, from the axis that is nearest to being at right angles to all before.
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
end module quad_lapack
