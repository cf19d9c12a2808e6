!> Tests. The closure equations with all of a deck's numbers in real128, so that each of them can be changed by less
!> than
!> a double can tell: what the condition of a position and of its derivatives is measured with.
module hard_closure
   use kinds, only: wp
   use quad_jet, only: qp, jet_t, constant_jet, time_jet, sin, cos, operator(+), operator(-), operator(*)
   use mechanism, only: mechanism_t, drive_t, pair_revolute, drive_angle, drive_relangle, drive_slide, drive_x, &
      term_harmonic, term_table
   use jet_closure, only: body_jet_t
   use jet_drives, only: drive_jet
   implicit none
   private
   public :: numbers_of, set_grounds, residuals, drive_changes

contains

   !> The numbers of the deck that place anything: three of a link (those of moving ones are rough and count as zero),
   !> two of
   !> a point, three of a pair, one after another.
   function numbers_of(m) result(d)
      type(mechanism_t), intent(in) :: m
      real(qp), allocatable :: d(:)
      integer :: i, n

      allocate (d(3*size(m%links) + 2*size(m%points) + 3*size(m%pairs)), source=0.0_qp)
      do i = 1, size(m%links)
         if (m%links(i)%ground) d(3*i - 2:3*i) = m%links(i)%position
      end do
      n = 3*size(m%links)
      do i = 1, size(m%points)
         d(n + 2*i - 1:n + 2*i) = m%points(i)%offset
      end do
      n = n + 2*size(m%points)
      do i = 1, size(m%pairs)
         if (m%pairs(i)%kind == pair_revolute) cycle
         d(n + 3*i - 2:n + 3*i) = [m%pairs(i)%alpha, m%pairs(i)%offset, m%pairs(i)%beta]
      end do
   end function numbers_of

   !> Puts the ground links where the numbers `d` say.
   subroutine set_grounds(m, d, b)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(body_jet_t), intent(inout) :: b(:)
      integer :: i

      do i = 1, size(b)
         if (m%links(i)%ground) b(i) = body_jet_t(constant_jet(d(3*i - 2)), constant_jet(d(3*i - 1)), &
            constant_jet(d(3*i)))
      end do
   end subroutine set_grounds

   !> Two of every pair, (7), (8) or (9), (10), and one of every drive, which asks for `f`; a jet each.
   function residuals(m, d, b, f) result(r)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(body_jet_t), intent(in) :: b(:)
      type(jet_t), intent(in) :: f(:)
      type(jet_t) :: r(2*size(m%pairs) + size(m%drives)), place(2, size(m%points)), e(2), gap(2)
      integer :: k, n

      place = places(m, d, b)
      n = 3*size(m%links) + 2*size(m%points)
      do k = 1, size(m%pairs)
         associate (p => m%pairs(k)%point_i, q => m%pairs(k)%point_j)
            gap = place(:, p) - place(:, q)
            if (m%pairs(k)%kind == pair_revolute) then
               r(2*k - 1:2*k) = gap
            else
               e = guide(b(m%points(p)%link)%phi + d(n + 3*k - 2))
               r(2*k - 1) = e(1)*gap(2) - e(2)*gap(1) - d(n + 3*k - 1)
               r(2*k) = b(m%points(q)%link)%phi - b(m%points(p)%link)%phi - d(n + 3*k)
            end if
         end associate
      end do
      do k = 1, size(m%drives)
         r(2*size(m%pairs) + k) = driven(m, d, b, place, k) - f(k)
      end do
   end function residuals

   !> What drive `k` moves.
   type(jet_t) function driven(m, d, b, place, k) result(s)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(body_jet_t), intent(in) :: b(:)
      type(jet_t), intent(in) :: place(:, :)
      integer, intent(in) :: k
      type(jet_t) :: gap(2), e(2)
      integer :: n

      associate (subject => m%drives(k)%subject)
         select case (m%drives(k)%kind)
         case (drive_angle)
            s = b(subject)%phi
         case (drive_relangle)
            s = b(m%drives(k)%second)%phi - b(subject)%phi
         case (drive_slide)
            n = 3*size(m%links) + 2*size(m%points)
            gap = place(:, m%pairs(subject)%point_j) - place(:, m%pairs(subject)%point_i)
            e = guide(b(m%points(m%pairs(subject)%point_i)%link)%phi + d(n + 3*subject - 2))
            s = e(1)*gap(1) + e(2)*gap(2)
         case default
            s = place(merge(1, 2, m%drives(k)%kind == drive_x), subject)
         end select
      end associate
   end function driven

   function guide(theta) result(e)
      type(jet_t), intent(in) :: theta
      type(jet_t) :: e(2)

      e(1) = cos(theta)
      e(2) = sin(theta)
   end function guide

   function places(m, d, b) result(place)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(body_jet_t), intent(in) :: b(:)
      type(jet_t) :: place(2, size(m%points)), e(2, size(b))
      integer :: i, n

      do i = 1, size(b)
         e(:, i) = guide(b(i)%phi)
      end do
      n = 3*size(m%links)
      do i = 1, size(m%points)
         associate (link => m%points(i)%link, u => d(n + 2*i - 1), w => d(n + 2*i))
            place(1, i) = b(link)%x + u*e(1, link) - w*e(2, link)
            place(2, i) = b(link)%y + u*e(2, link) + w*e(1, link)
         end associate
      end do
   end function places

   !> By how much (changes) the law of a drive changes at `t` with each of its numbers, times that number. The exponent
   !> of
   !> a power counts as exact.
   function drive_changes(drive, t) result(c)
      type(drive_t), intent(in) :: drive
      real(qp), intent(in) :: t
      type(jet_t), allocatable :: c(:)
      type(drive_t) :: one
      integer :: i, k

      allocate (c(0))
      do k = 1, 3
         one = alone(drive, 0)
         one%polynomial(k) = drive%polynomial(k)
         if (abs(drive%polynomial(k)) > 0.0_wp) c = [c, drive_jet(one, t)]
      end do
      do i = 1, size(drive%terms)
         c = [c, term_changes(alone(drive, i), t)]
      end do
   end function drive_changes

   !> The same of a drive that has one term alone.
   function term_changes(drive, t) result(c)
      type(drive_t), intent(in) :: drive
      real(qp), intent(in) :: t
      type(jet_t), allocatable :: c(:)
      type(drive_t) :: one
      integer :: k

      one = drive
      associate (term => one%terms(1))
         if (term%kind == term_table) then
            allocate (c(size(term%values)))
            do k = 1, size(c)
               term%values = 0.0_wp
               term%values(k) = drive%terms(1)%values(k)
               c(k) = drive_jet(one, t)
            end do
            return
         end if
         c = [drive_jet(one, t)]
         if (term%kind /= term_harmonic) return
         ! The derivative of a sine is the sine a quarter turn on.
         term%r(3) = term%r(3) + acos(0.0_wp)
         associate (r => drive%terms(1)%r)
            c = [c, real(r(3), qp)*drive_jet(one, t), real(r(2), qp)*time_jet(t)*drive_jet(one, t)]
         end associate
      end associate
   end function term_changes

   !> `drive` without its polynomial and with term `i` alone, 0: none.
   function alone(drive, i) result(one)
      type(drive_t), intent(in) :: drive
      integer, intent(in) :: i
      type(drive_t) :: one

      one = drive
      one%polynomial = 0.0_wp
      if (i == 0) then
         one%terms = drive%terms(:0)
      else
         one%terms = drive%terms(i:i)
      end if
   end function alone
end module hard_closure
