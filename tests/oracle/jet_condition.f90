!> Tests. The condition of the closure equations at a position, from the columns that unit velocities give; and what
!> rounding in double precision may leave of them.
module jet_condition
   use kinds, only: wp
   use quad_jet, only: qp, jet_t
   use mechanism, only: mechanism_t, pair_prismatic, drive_angle, drive_relangle
   use scales, only: characteristic_length
   use jet_closure, only: body_jet_t, closure_slopes, numbers_of
   use jet_drives, only: drive_sizes
   use lapack, only: gesvd
   implicit none
   private
   public :: condition, sizes_t, sizes_of, row_sizes

   real(qp), parameter :: many_roundings = 16.0_qp

   !> Sizes of the numbers that positions, velocities and accelerations are added up from: of lengths and of angles.
   type :: sizes_t
      real(qp) :: length(0:2) = 0.0_qp, angle(0:2) = 0.0_qp
   end type sizes_t

contains

   !> Largest over smallest singular value, the columns of x and y in units of the largest body vector, rows brought to
   !> the size 1 (a row's size says nothing about the position). `huge` where the smallest is zero. There may be more
   !> rows than columns.
   function condition(m, b)
      type(mechanism_t), intent(in) :: m
      type(body_jet_t), intent(in) :: b(:)
      real(qp) :: condition
      real(qp) :: slopes(2*size(m%pairs) + size(m%drives), 3*count(.not. m%links%ground)), body_vector
      real(wp) :: a(size(slopes, 1), size(slopes, 2)), s(size(slopes, 2)), work(8*(size(slopes, 1) + size(slopes, 2)))
      real(wp) :: left(size(slopes, 1), size(slopes, 1)), right(size(slopes, 2), size(slopes, 2))
      integer :: c, n, info

      condition = huge(1.0_wp)
      n = size(slopes, 2)
      if (n == 0 .or. n > size(slopes, 1)) return
      body_vector = longest_vector(m)
      if (.not. body_vector > 0.0_qp) body_vector = 1.0_qp
      slopes = closure_slopes(m, numbers_of(m), b)
      slopes(:, 1::3) = body_vector*slopes(:, 1::3)
      slopes(:, 2::3) = body_vector*slopes(:, 2::3)
      do c = 1, size(slopes, 1)
         a(c, :) = real(slopes(c, :)/max(maxval(abs(slopes(c, :))), tiny(1.0_wp)*1.0_qp), wp)
      end do
      call gesvd('A', 'A', size(a, 1), n, a, size(a, 1), s, left, size(left, 1), right, size(right, 1), work, &
         size(work), info)
      if (info == 0 .and. s(n) > 0.0_wp) condition = real(s(1), qp)/s(n)
   end function condition

   !> The largest offset of any point or pair.
   pure function longest_vector(m) result(body_vector)
      type(mechanism_t), intent(in) :: m
      real(qp) :: body_vector
      integer :: i

      body_vector = 0.0_qp
      do i = 1, size(m%points)
         body_vector = max(body_vector, maxval(abs(real(m%points(i)%offset, qp))))
      end do
      do i = 1, size(m%pairs)
         if (m%pairs(i)%kind == pair_prismatic) body_vector = max(body_vector, abs(real(m%pairs(i)%offset, qp)))
      end do
   end function longest_vector

   !> Sizes of the motion `b` of mechanism `m`. An angle is known to one part in 2**53 of itself, a direction no better,
   !> so that body vectors count times 1 + |phi|; a velocity turns with every angular velocity, an acceleration
   !> likewise. One linear solve gives lengths and angles: what rounding leaves in one, over the longest body vector, it
   !> may leave in the other. The characteristic length counts as one: all coordinates may be zero, and lengths are
   !> computed in units of it.
   function sizes_of(m, b) result(s)
      type(mechanism_t), intent(in) :: m
      type(body_jet_t), intent(in) :: b(:)
      type(sizes_t) :: s
      real(qp) :: turn, body_vector
      integer :: i

      s%angle = [1.0_qp + maxval(abs(b%phi%v)), maxval(abs(b%phi%d)), maxval(abs(b%phi%dd))]
      turn = s%angle(0)
      body_vector = max(real(characteristic_length(m), qp), longest_vector(m))
      do i = 1, size(m%pairs)
         if (m%pairs(i)%kind == pair_prismatic) turn = max(turn, 1.0_qp + abs(real(m%pairs(i)%alpha, qp)))
      end do
      s%length(0) = max(maxval(abs(b%x%v)), maxval(abs(b%y%v))) + body_vector*turn
      s%length(1) = max(maxval(abs(b%x%d)), maxval(abs(b%y%d)))*turn + s%length(0)*s%angle(1)
      s%length(2) = max(maxval(abs(b%x%dd)), maxval(abs(b%y%dd)))*turn + s%length(1)*s%angle(1) &
         + s%length(0)*(s%angle(2) + s%angle(1)**2)
      if (body_vector > 0.0_qp) s%angle = s%angle + s%length/body_vector
   end function sizes_of

   !> Sizes (0:2, equations) of the numbers in each equation and its derivatives.
   function row_sizes(m, s, t) result(rows)
      type(mechanism_t), intent(in) :: m
      type(sizes_t), intent(in) :: s
      real(qp), intent(in) :: t
      real(qp) :: rows(0:2, 2*size(m%pairs) + size(m%drives))
      integer :: k

      do k = 1, size(m%pairs)
         rows(:, 2*k - 1) = s%length
         ! Body vectors of many turns: 64 roundings of a length are one of the angle in its direction.
         rows(0, 2*k - 1) = s%length(0)*max(1.0_qp, s%angle(0)/many_roundings)
         rows(:, 2*k) = rows(:, 2*k - 1)
         if (m%pairs(k)%kind /= pair_prismatic) cycle
         rows(:, 2*k) = s%angle
         rows(0, 2*k) = max(rows(0, 2*k), abs(real(m%pairs(k)%beta, qp)))
      end do
      do k = 1, size(m%drives)
         associate (row => rows(:, 2*size(m%pairs) + k))
            row = s%length
            if (any(m%drives(k)%kind == [drive_angle, drive_relangle])) row = s%angle
            row = row + drive_sizes(m%drives(k), t)
         end associate
      end do
   end function row_sizes
end module jet_condition
