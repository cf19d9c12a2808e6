!> Diagnostics of an instant, beside its numbers, and remarks about a deck, as data: results/ has their words.
module diagnostics
   use kinds, only: wp
   implicit none
   private
   public :: diagnostic_t, new_diagnostic, max_links, remark_t
   public :: diagnostic_inconsistent, diagnostic_limit, diagnostic_far_estimate, diagnostic_second, &
      diagnostic_redundant, diagnostic_mobile, diagnostic_change, diagnostic_long, diagnostic_close, &
      diagnostic_unused, &
      diagnostic_dead_end, diagnostic_idle, diagnostic_repeated, diagnostic_method, diagnostic_singular
   public :: remark_small_letters, remark_title_long, remark_title_letters, remark_touching, remark_link_unused, &
      remark_point_unused, remark_radians, remark_guide, remark_jumps, remark_more

   !> The kinds of diagnostics, and the components that each uses.
   enum, bind(c)
      enumerator :: diagnostic_inconsistent = 1 !< an equation of `pair` or `drive` has the closure error `value`
      enumerator :: diagnostic_limit            !< at `t`, where `drive` is `value`, the motion of `links` has its limit
      enumerator :: diagnostic_far_estimate     !< the estimated angle of links(1) was off by `value`
      enumerator :: diagnostic_second           !< another assembly of `links` is about as near
      enumerator :: diagnostic_redundant        !< `equations` equations of `pair` or `drive` are redundant
      enumerator :: diagnostic_mobile           !< `links` can move although no drive does
      enumerator :: diagnostic_change           !< at `t` two branches cross; `other`: `links` took the other one
      enumerator :: diagnostic_long             !< the step from `t` would need too many substeps
      enumerator :: diagnostic_unused           !< no change point was passed after `t`, as a BRANCH card asks
      enumerator :: diagnostic_dead_end         !< the other branch of `links` at `t` was not found
      enumerator :: diagnostic_idle             !< the pairs already fix what `drive` drives
      enumerator :: diagnostic_repeated         !< other drives already give what `drive` drives
      enumerator :: diagnostic_method           !< another method finds a position
      enumerator :: diagnostic_close            !< at `t` the motion is blocked, and no limit is told
      enumerator :: diagnostic_singular         !< the position of `links` is singular: a part of its mark's sentence
   end enum

   !> The kinds of remarks: what a deck has that is harmless, or likely not what was meant.
   enum, bind(c)
      enumerator :: remark_small_letters = 1    !< small letters are read as capitals
      enumerator :: remark_title_long           !< a title is cut
      enumerator :: remark_title_letters        !< a title has letters that are not ASCII
      enumerator :: remark_touching             !< two numbers touch
      enumerator :: remark_link_unused          !< no pair and no drive uses a link: it rests
      enumerator :: remark_point_unused         !< no pair, drive or PRINT card uses a point
      enumerator :: remark_radians              !< an angle in radians looks like one in degrees
      enumerator :: remark_guide                !< a guide fits its points if it is turned by a right angle
      enumerator :: remark_jumps                !< the acceleration of a rise jumps
      enumerator :: remark_more                 !< there are more remarks, `text` says how many
   end enum

   !> Links that a diagnostic can name.
   integer, parameter :: max_links = 6

   !> One diagnostic. Lengths are in the deck's unit, angles in radians; 0 stands for no pair, drive or link.
   type :: diagnostic_t
      integer :: kind = 0                      !< diagnostic_inconsistent, ...
      integer :: pair = 0, drive = 0           !< their numbers in the set
      integer :: links(max_links) = 0          !< the numbers of links
      integer :: more = 0                      !< links for which there is no room
      integer :: equations = 1                 !< diagnostic_redundant: number of equations
      logical :: in_line = .false.             !< diagnostic_limit, diagnostic_singular: the two links are in line
      logical :: other = .false.     !< diagnostic_change: on the other branch; diagnostic_method: at another assembly
      logical :: here = .false.                !< diagnostic_change: the instant is the change point
      logical :: is_angle = .false.            !< `value` is an angle, not a length
      real(wp) :: value = 0.0_wp               !< closure error, angle or drive's value (length or rad)
      real(wp) :: t = 0.0_wp                   !< time, in the deck's unit
   end type diagnostic_t

   !> A remark about `text`, which begins at `column` of a card.
   type :: remark_t
      integer :: kind = 0                      !< remark_small_letters, ...
      integer :: card = 0, column = 0          !< number of the card in the deck, and column
      character(24) :: text = ''
   end type remark_t

contains

   !> A diagnostic of `kind` about the links (links) that are true in `chosen`, as many as there is room for.
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
