!> What there is to say of an instant beside its numbers, as data: the writers find the words.
module diagnostics
   use kinds, only: wp
   implicit none
   private
   public :: diagnostic_t, new_diagnostic, max_links
   public :: diagnostic_inconsistent, diagnostic_limit, diagnostic_far_estimate, diagnostic_second, &
      diagnostic_redundant, diagnostic_mobile, &
      diagnostic_change, diagnostic_long, diagnostic_unused, diagnostic_dead_end, &
      diagnostic_idle, diagnostic_repeated, diagnostic_method

   integer, parameter :: diagnostic_inconsistent = 1       !< an equation of `pair` or `drive` stays open by `value`
   integer, parameter :: diagnostic_limit = 2 !< at `t`, where `drive` has `value`, the motion of `links` has its limit
   integer, parameter :: diagnostic_far_estimate = 3 !< the rough position of links(1) was off by the angle `value`
   integer, parameter :: diagnostic_second = 4     !< `links` could as well have been assembled in another way
   integer, parameter :: diagnostic_redundant = 5  !< an equation of `pair` or `drive` could be spared
   integer, parameter :: diagnostic_mobile = 6     !< `links` can move although the drives stand still
   integer, parameter :: diagnostic_change = 7     !< at `t` two branches cross; `links` have gone on smoothly, or not
   integer, parameter :: diagnostic_long = 8       !< the way from `t` would take too many parts
   integer, parameter :: diagnostic_unused = 9     !< no change point was passed after `t`, as a BRANCH card has it
   integer, parameter :: diagnostic_dead_end = 10  !< the other branch of `links` at `t` was not found
   integer, parameter :: diagnostic_idle = 11      !< `drive` asks for what the pairs fix anyway
   integer, parameter :: diagnostic_repeated = 12  !< `drive` asks for what others give already
   integer, parameter :: diagnostic_method = 13    !< another method finds a position

   integer, parameter :: max_links = 6

   !> Lengths in the deck's unit, angles in radians; 0 stands for no pair, drive or link.
   type :: diagnostic_t
      integer :: kind = 0
      integer :: pair = 0, drive = 0
      integer :: links(max_links) = 0
      integer :: more = 0                      !< links for which there is no room
      integer :: equations = 1                 !< remark_redundant: how many of them
      logical :: in_line = .false.             !< remark_limit: the two links are in line
      logical :: other = .false.               !< remark_change: on the other branch; remark_method: at another assembly
      logical :: here = .false.                !< remark_change: the instant is the change point
      logical :: is_angle = .false.            !< of `value`
      real(wp) :: value = 0.0_wp, t = 0.0_wp
   end type diagnostic_t

contains

   !> A remark on those links that are `.true.` in `chosen`, as many as there is room for.
   pure function new_diagnostic(kind, chosen) result(r)
      integer, intent(in) :: kind
      logical, intent(in) :: chosen(:)
      type(diagnostic_t) :: r
      integer :: i, n

      r%kind = kind
      n = 0
      do i = 1, size(chosen)
         if (.not. chosen(i)) cycle
         n = n + 1
         if (n <= max_links) r%links(n) = i
      end do
      r%more = max(0, n - max_links)
   end function new_diagnostic
end module diagnostics
