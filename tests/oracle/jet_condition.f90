!> Tests. The condition of the closure equations at a position, from the columns that unit velocities give.
module jet_condition
   use kinds, only: wp
   use quad_jet, only: qp, jet_t, constant_jet
   use mechanism, only: mechanism_t, pair_prismatic
   use jet_closure, only: body_jet_t, closure_jets
   use lapack, only: gesvd
   implicit none
   private
   public :: condition

contains

   !> Largest over smallest singular value, the columns of x and y in units of the largest arm, rows brought to the
   !> size 1 (a row's size says nothing about the position). `huge` where the smallest is zero. There may be more rows
   !> than columns.
   function condition(m, b, t)
      type(mechanism_t), intent(in) :: m
      type(body_jet_t), intent(in) :: b(:)
      real(qp), intent(in) :: t
      real(qp) :: condition
      type(body_jet_t) :: moving(size(b))
      type(jet_t) :: r(2*size(m%pairs) + size(m%drives))
      real(qp) :: column(size(r), 3*size(b)), body_vector
      real(wp) :: a(size(r), 3*size(b)), s(3*size(b)), work(8*(size(r) + 3*size(b)))
      real(wp) :: left(size(r), size(r)), right(3*size(b), 3*size(b))
      integer :: link, c, n, info

      body_vector = longest_arm(m)
      n = 0
      do link = 1, size(b)
         if (m%links(link)%ground) cycle
         do c = 1, 3
            moving = still(b)
            if (c == 1) moving(link)%x%d = body_vector
            if (c == 2) moving(link)%y%d = body_vector
            if (c == 3) moving(link)%phi%d = 1.0_qp
            n = n + 1
            ! The drives' own rates are no part of the Jacobian.
            r = closure_jets(m, moving, t)
            column(:, n) = r%d
            r = closure_jets(m, still(b), t)
            column(:, n) = column(:, n) - r%d
         end do
      end do
      condition = huge(1.0_wp)
      if (n == 0 .or. n > size(r)) return
      do c = 1, size(r)
         a(c, :n) = real(column(c, :n)/max(maxval(abs(column(c, :n))), tiny(1.0_wp)*1.0_qp), wp)
      end do
      call gesvd('A', 'A', size(r), n, a, size(r), s, left, size(r), right, size(right, 1), work, size(work), info)
      if (info == 0 .and. s(n) > 0.0_wp) condition = real(s(1), qp)/s(n)
   end function condition

   !> The positions of `b` at rest.
   pure function still(b) result(s)
      type(body_jet_t), intent(in) :: b(:)
      type(body_jet_t) :: s(size(b))

      s%x = constant_jet(b%x%v)
      s%y = constant_jet(b%y%v)
      s%phi = constant_jet(b%phi%v)
   end function still

   !> The largest offset of any point or pair; 1 where there is none.
   pure function longest_arm(m) result(body_vector)
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
      if (.not. body_vector > 0.0_qp) body_vector = 1.0_qp
   end function longest_arm
end module jet_condition
