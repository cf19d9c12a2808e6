!> Tests. The scissor lift of tests/make_deck with the four half rods of each stage as they come, in real128; and its
!> condition, for which all equations at once would be too many.
module hard_chain
   use quad_jet, only: qp, jet_t, constant_jet, operator(+), operator(-), operator(*)
   use mechanism, only: mechanism_t
   use jet_drives, only: drive_jet, drive_changes
   use closed_forms_dyads, only: place_t, body_t, fixed_place, body, polar, direction, corner, on_line
   implicit none
   private
   public :: rods_t, rods_of, scissor_form, scissor_condition

   !> (4, stages) of rod A from its foot to the middle and to its tip, of rod B the same.
   type :: rods_t
      real(qp), allocatable :: length(:, :)
   end type rods_t

contains

   !> From the points C (0), D, E of each rod A and F (0), H, K of each rod B. The last stage has no tips.
   function rods_of(m) result(r)
      type(mechanism_t), intent(in) :: m
      type(rods_t) :: r
      integer :: i, k

      allocate (r%length(4, (size(m%links) - 2)/2), source=0.0_qp)
      do i = 1, size(m%points)
         k = index('DEHK', m%points(i)%name(1:1))
         if (k == 0 .or. m%links(m%points(i)%link)%ground) cycle
         r%length(k, number_in(m%points(i)%name)) = m%points(i)%offset(1)
      end do
   end function rods_of

   integer function number_in(name) result(number)
      character(*), intent(in) :: name

      read (name(2:), *) number
   end function number_in

   !> The links with rod A of the first stage at `phi`.
   function scissor_form(r, phi) result(links)
      type(rods_t), intent(in) :: r
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(2 + 2*size(r%length, 2))
      type(place_t) :: left, right, middle, foot
      type(jet_t) :: flat
      character(6) :: number
      integer :: i

      flat = constant_jet(0.0_qp)
      left = fixed_place(0.0_qp, 0.0_qp)
      links(1) = body('BASE', left, flat)
      middle = polar(left, r%length(1, 1), phi)
      right = on_line(middle, r%length(3, 1), left, flat, 1.0_qp)
      links(2) = body('BLOCK', right, flat)
      do i = 1, size(r%length, 2)
         write (number, '(i0)') i
         if (i > 1) middle = corner(left, r%length(1, i), right, r%length(3, i), 1.0_qp)
         links(2*i + 1) = body('A'//trim(number), left, direction(left, middle))
         links(2*i + 2) = body('B'//trim(number), right, direction(right, middle))
         foot = beyond(right, middle, r%length(4, i)/r%length(3, i))
         right = beyond(left, middle, r%length(2, i)/r%length(1, i))
         left = foot
      end do
   end function scissor_form

   !> From `p` towards `q` and on, `times` the way.
   type(place_t) function beyond(p, q, times)
      type(place_t), intent(in) :: p, q
      real(qp), intent(in) :: times

      beyond = place_t(p%x + times*(q%x - p%x), p%y + times*(q%y - p%y))
   end function beyond

   !> As `measure` of hard_condition: (3, links, 0:2) sums of |dy/dd| |d|, and |y|. `links`: the form's order.
   function scissor_condition(m, r, t) result(c)
      type(mechanism_t), intent(in) :: m
      type(rods_t), intent(in) :: r
      real(qp), intent(in) :: t
      real(qp) :: c(3, size(m%links), 0:2), y(3, size(m%links), 0:2)
      type(rods_t) :: other
      type(jet_t) :: phi
      type(jet_t), allocatable :: change(:)
      real(qp), parameter :: step = 1.0e-20_qp
      integer :: i, k

      phi = drive_jet(m%drives(1), t)
      y = coordinates(m, scissor_form(r, phi))
      c = abs(y)
      other = r
      do i = 1, size(r%length, 2)
         do k = 1, 4
            if (.not. r%length(k, i) > 0.0_qp) cycle
            other%length(k, i) = r%length(k, i)*(1.0_qp + step)
            c = c + abs(coordinates(m, scissor_form(other, phi)) - y)/step
            other%length(k, i) = r%length(k, i)
         end do
      end do
      change = drive_changes(m%drives(1), t)
      do i = 1, size(change)
         c = c + abs(coordinates(m, scissor_form(r, phi + step*change(i))) - y)/step
      end do
   end function scissor_condition

   !> In the deck's order, which make_deck has chosen as above.
   function coordinates(m, links) result(y)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: links(:)
      real(qp) :: y(3, size(m%links), 0:2)
      integer :: i

      do i = 1, size(links)
         if (links(i)%name /= m%links(i)%name) error stop 'THE ORDER OF THE LINKS'
         y(:, i, 0) = [links(i)%x%v, links(i)%y%v, links(i)%phi%v]
         y(:, i, 1) = [links(i)%x%d, links(i)%y%d, links(i)%phi%d]
         y(:, i, 2) = [links(i)%x%dd, links(i)%y%dd, links(i)%phi%dd]
      end do
   end function coordinates
end module hard_chain
