!> Tests. Random mechanisms as plain data, from ground links outwards: the groups of `scheme_groups`, near a singularity
!> or not, each with as many drives as it has freedoms. The position comes first, so that every mechanism is assembled
!> at t = 0 as far as rounding lets it be.
module random_mechanisms
   use kinds, only: wp
   use quad_jet, only: qp
   use failures, only: failure_t
   use mechanism, only: mechanism_t, drive_x, drive_y
   use deck, only: read_deck
   use dice, only: new_dice, throw, chance
   use schemes, only: write_scheme, form_any
   use scheme_builder, only: builder_t, new_builder, number, anywhere, add_links, join, pick_base, begin_group, shuffle
   use scheme_drives, only: add_drive, add_point_drive
   use scheme_groups, only: add_crank, add_slider, add_dyad, add_plates, add_net, add_open_chain, add_floating, &
      add_cylinder, add_table
   implicit none
   private
   public :: random_mechanism

contains

   !> Mechanism number `seed` of `groups` groups; `special`: how often angles are right, coordinates whole and joints
   !> shared.
   function random_mechanism(seed, groups, special) result(m)
      integer, intent(in) :: seed, groups
      real(wp), intent(in) :: special
      type(mechanism_t) :: m
      type(builder_t), allocatable :: d
      integer :: k, ground

      allocate (d)
      d = new_builder(new_dice(seed))
      d%special = special
      d%shared = special
      d%to = 1.0_qp
      d%s%at = [0.0_qp]
      ground = throw(d%dice, 3)
      k = add_links(d, ground, .true.)
      call add_crank(d, 0.8_qp)
      do k = 2, groups
         call add_group(d, number(d, 0.05_qp, 0.8_qp))
      end do
      call shuffle(d)
      d%s%print = 'LINKS'
      ! Tables of some links alone.
      if (chance(d%dice, 0.3_wp)) &
         d%s%printed = [(k, k=ground + throw(d%dice, size(d%s%links) - ground), size(d%s%links))]
      m = as_read(d)
   end function random_mechanism

   !> The mechanism of the builder `d`, as the reader of decks makes it, but without instants.
   function as_read(d) result(m)
      type(builder_t), intent(in) :: d
      type(mechanism_t) :: m
      character(*), parameter :: path = 'unit_test_random.tmp'
      type(mechanism_t), allocatable :: sets(:)
      type(failure_t), allocatable :: failure
      character(:), allocatable :: report
      integer :: unit

      open (newunit=unit, file=path, status='replace', action='readwrite')
      call write_scheme(d%s, unit)
      flush (unit)
      call read_deck(path, sets, report, failure)
      close (unit, status='delete')
      if (allocated(failure)) error stop 'A RANDOM MECHANISM IS NOT READ'
      m = sets(1)
      m%at = m%at(:0)
   end function as_read

   subroutine add_group(d, way)
      type(builder_t), intent(inout) :: d
      real(qp), intent(in) :: way

      select case (throw(d%dice, 16))
      case (1); call add_crank(d, way)
      case (2); call add_slider(d, way)
      case (3); call add_driven_ends(d, 1, way)
      case (4:9); call add_dyad(d)
      case (10); call add_driven_ends(d, 2, way)
      case (11); call add_plates(d, 1)
      case (12); call add_net(d)
      case (13); call add_cylinder(d, way)
      case (14); call add_floating(d, way)
      case (15); call add_table(d, way)
      case default; call add_open_chain(d, way)
      end select
   end subroutine add_group

   !> One link that turns, driven by a coordinate of its end; or two in a row, driven by both.
   subroutine add_driven_ends(d, links, way)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: links
      real(qp), intent(in) :: way
      integer :: first

      call begin_group(d, form_any)
      first = add_links(d, links, .false.)
      call join(d, pick_base(d), first, .false., anywhere(d))
      if (links == 1) then
         call add_point_drive(d, merge(drive_x, drive_y, chance(d%dice, 0.5_wp)), first, way)
      else
         call join(d, first, first + 1, .false., anywhere(d))
         call add_point_drive(d, drive_x, first + 1, way)
         call add_drive(d, drive_y, size(d%s%points), 0, way)
      end if
   end subroutine add_driven_ends
end module random_mechanisms
