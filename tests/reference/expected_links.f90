!> Tests. The links of a deck at any time by its closed form, angles without leaps; and with one drive that moves alone.
module expected_links
   use mechanism, only: mechanism_t
   use quad_jet, only: qp, jet_t, constant_jet, time_jet, wrap_angle
   use closed_forms_dyads, only: body_t
   use closed_forms, only: closed_form
   use closed_forms_ratios, only: ratio_laws, by_drives
   implicit none
   private
   public :: move_links_to, links_by_drive, sort_links

contains

   !> Puts `links` (in the order of the deck `name`) where the closed form has them at `t`, with angles next to what
   !> they were before. `fault`: what does not fit, '' if all does.
   subroutine move_links_to(name, m, t, links, fault)
      character(*), intent(in) :: name
      class(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: t
      type(body_t), intent(inout) :: links(:)
      character(:), allocatable, intent(out) :: fault

      call put_links(m, closed_form(name, merge(m%variant, m%set_number, m%variant > 0), t), links, fault)
   end subroutine move_links_to

   !> The `links` at the time `t` in a motion in which drive number `drive` has the rate 1, and all others rest.
   function links_by_drive(name, m, t, links, drive) result(moved)
      character(*), intent(in) :: name
      class(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: t
      type(body_t), intent(in) :: links(:)
      integer, intent(in) :: drive
      type(body_t) :: moved(size(links))
      type(jet_t), allocatable :: f(:)
      character(:), allocatable :: fault

      f = ratio_laws(name, time_jet(t))
      if (size(f) < drive) error stop 'NO CLOSED FORM OF RATIOS FOR THE DECK'
      f = constant_jet(f%v)
      f(drive)%d = 1.0_qp
      moved = links
      call put_links(m, by_drives(name, f), moved, fault)
   end function links_by_drive

   !> Puts `links` where they are `found`, as `move_links_to`.
   subroutine put_links(m, found, links, fault)
      class(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: found(:)
      type(body_t), intent(inout) :: links(:)
      character(:), allocatable, intent(out) :: fault
      real(qp) :: before(size(links))

      before = links%phi%v
      call sort_links(m, found, links, fault)
      links%phi%v = before + wrap_angle(links%phi%v - before)
   end subroutine put_links

   !> The links of a closed form, `found`, in the order of the deck of `m`. `fault`: what does not fit, '' if all does.
   subroutine sort_links(m, found, links, fault)
      class(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: found(:)
      type(body_t), intent(inout) :: links(:)
      character(:), allocatable, intent(out) :: fault
      integer :: k, i

      fault = ''
      if (size(found) /= size(m%links)) fault = 'THE CLOSED FORM AND THE DECK DIFFER IN THEIR LINKS'
      do i = 1, size(found)
         if (fault /= '') return
         k = findloc(m%links%name == found(i)%name, .true., dim=1)
         if (k == 0) fault = 'THE DECK HAS NO LINK '//found(i)%name
         if (k > 0) links(k) = found(i)
      end do
   end subroutine sort_links
end module expected_links
