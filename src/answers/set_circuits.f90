!> The ranges and the circuits of all drives of a set, from its first instant.
module set_circuits
   use kinds, only: wp
   use motion, only: diagnostic_t, diagnostic_limit
   use set_analysis, only: set_analysis_t
   use assemblies, only: assemblies_t, find_assemblies
   use circuit_trace, only: end_closed
   use circuits, only: circuits_t, revolutions_of, find_circuits
   use ranges, only: range_t, find_range, lower_end, upper_end
   implicit none
   private
   public :: find_ranges, find_all_circuits, known

   !> A value below this, in rad or lengths of the order of 1, is rounding of 0.
   real(wp), parameter :: zero_value = 1.0e3_wp*epsilon(1.0_wp)
   !> Ranges with ends that differ by less, in rad or characteristic lengths, are equal.
   real(wp), parameter :: equal_range = sqrt(epsilon(1.0_wp))

contains

   !> Finds the ranges of all drives of a set at its first instant. If a mechanism has no position there, its branches
   !> have ranges, if all of its circuits are known; a variant has none.
   subroutine find_ranges(set, list)
      type(set_analysis_t), intent(in) :: set   !< at its first instant
      type(range_t), allocatable, intent(out) :: list(:)   !< (any number) by drives
      type(range_t) :: r
      type(circuits_t) :: found
      type(assemblies_t) :: first
      integer :: c, i

      allocate (list(0))
      do c = 1, set%now%count
         if (set%now%motions(c)%known < 0) then
            if (set%now%variants > 0) cycle
            first = first_assemblies(set, c)
         end if
         do i = 1, size(set%now%parts(c)%drives)
            if (set%now%motions(c)%known >= 0) then
               call find_range(set%now%parts(c), set%now%motions(c), i, r)
               r%part = c
               r%limit%part = c
               list = [list, r]
            else
               call find_circuits(set%now%parts(c), set%now%motions(c), i, first, found)
               found%part = c
               if (found%is_complete .and. .not. found%are_more) call add_branch_ranges(found, list)
            end if
         end do
      end do
   end subroutine find_ranges

   !> Adds the range of the drive on each branch of its circuits; equal ranges once.
   subroutine add_branch_ranges(found, list)
      type(circuits_t), intent(in) :: found   !< all circuits of a drive
      type(range_t), allocatable, intent(inout) :: list(:)   !< (any number) by drives; gets further ones
      type(range_t) :: r
      integer :: k, i, side

      do k = 1, size(found%branches)
         associate (b => found%branches(k), circuit => found%list(found%branches(k)%circuit))
            if (circuit%rests) cycle
            r = range_t(part=found%part, drive=found%drive, is_of_branch=.true., has_limit=b%dead > 0)
            r%is_all = all(circuit%ends == end_closed) .and. all(b%dead == 0)
            if (r%is_all) r%turns = revolutions_of(circuit)
            do side = lower_end, upper_end
               r%limit(side) = diagnostic_t(kind=diagnostic_limit, drive=found%drive, is_angle=found%curve%is_angle)
               if (r%has_limit(side)) r%limit(side) = found%dead(b%dead(side))
               r%limit(side)%part = found%part
               r%limit(side)%value = known(b%range(side))
            end do
         end associate
         do i = 1, size(list)
            if (list(i)%part == r%part .and. list(i)%drive == r%drive .and. (list(i)%is_all .eqv. r%is_all) &
               .and. all(abs(list(i)%limit%value - r%limit%value) <= equal_range*found%curve%closure%length)) exit
         end do
         if (i > size(list)) list = [list, r]
      end do
   end subroutine add_branch_ranges

   !> Finds the circuits of each drive of a set from its first instant; the other drives keep their values.
   subroutine find_all_circuits(set, list)
      type(set_analysis_t), intent(in) :: set   !< at its first instant
      type(circuits_t), allocatable, intent(out) :: list(:)   !< (drives of the set) part after part
      type(assemblies_t) :: first
      integer :: c, i, n

      allocate (list(sum([(size(set%now%parts(c)%drives), c=1, set%now%count)])))
      n = 0
      do c = 1, set%now%count
         if (size(set%now%parts(c)%drives) > 0) first = first_assemblies(set, c)
         do i = 1, size(set%now%parts(c)%drives)
            n = n + 1
            call find_circuits(set%now%parts(c), set%now%motions(c), i, first, list(n))
            list(n)%part = c
         end do
      end do
   end subroutine find_all_circuits

   !> Gives the assemblies of a part at the first instant. They are searched for only if the set does not have them.
   function first_assemblies(set, part) result(first)
      type(set_analysis_t), intent(in) :: set   !< at its first instant
      integer, intent(in) :: part                !< the number of the independent mechanism
      type(assemblies_t) :: first

      if (allocated(set%assemblies)) then
         first = set%assemblies(part)
      else
         call find_assemblies(set%now%parts(part), set%now%motions(part)%t, first)
      end if
   end function first_assemblies

   !> Gives a value, or 0 if the value is no more than rounding of 0.
   pure real(wp) function known(value)
      real(wp), intent(in) :: value              !< rad or length

      known = merge(0.0_wp, value, abs(value) <= zero_value)
   end function known
end module set_circuits
