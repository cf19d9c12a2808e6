!> Diagnostics: of the first motion, of a limit of motion, and of singular positions.
module block_diagnostics
   use kinds, only: wp
   use drive_path, only: drive_path_t, drive_at
   use motion, only: diagnostic_t, new_diagnostic, diagnostic_limit, diagnostic_second, diagnostic_redundant, &
      diagnostic_mobile, diagnostic_far_estimate, diagnostic_singular, &
      diagnostic_incomplete, diagnostic_change, singular_unclear, singular_change, motion_t
   use plane_vectors, only: wrap_angle
   use scales, only: is_length
   use blocks, only: blocks_t, geometry_t, blocks_below, largest_known, own_unknowns
   use block_rank, only: redundant_rows, moving_unknowns
   use block_state, only: state_t, largest_drive_rate
   use predictor, only: history_t
   use initial_estimate, only: guess_t
   use block_motion, only: flag_singular_links
   use singular_position, only: block_singularity
   implicit none
   private
   public :: start_diagnostics, limit_diagnostic, get_link_flags, change_diagnostics, diagnostic_at_change, &
      links_of

   !> rad: an estimated angle that is off by more gets a diagnostic: another assembly may have been meant.
   real(wp), parameter :: far_estimate = 1.0_wp
   !> A limit is reported if it is no further than this part of the step that could not be made.
   real(wp), parameter, public :: near_limit_part = max(1.0e-6_wp, 64.0_wp*epsilon(1.0_wp))
   !> At its own limit a block is nearly singular: its least pivot is below this part of the Lipschitz constant.
   real(wp), parameter :: near_singular_pivot = 0.05_wp
   !> At its own limit an unknown of a block is faster than the drives by more than this factor.
   real(wp), parameter :: much_faster = 10.0_wp
   !> Of two blocks with limits the later in solving order counts only if its time left is below this part of the other.
   real(wp), parameter :: much_nearer = 0.5_wp
   !> A slide s on its way to infinity is at least this long, in units of its loop.
   real(wp), parameter :: far_slide = 10.0_wp
   !> For a slide on its way to infinity s s''/s'^2, which is 2 at a pole, differs from 2 by no more than this.
   real(wp), parameter :: pole_tolerance = 0.2_wp
   !> Body vectors with a smaller sine between them are in line. Reason: the last motion before a limit is off in angle
   !> by about the root of its distance in time, `near_limit_part`.
   real(wp), parameter :: in_line_sine = 1.0e-3_wp

contains

   !> Lists the diagnostics of the first motion, in this order:
   !>
   !> - each pair and drive with redundant equations,
   !> - if a Jacobian has no inverse: the links that can still move,
   !> - otherwise each block of which another assembly is about as near to the initial guess, or may be nearer,
   !> - the link whose angle was estimated the worst, if it is off by more than `far_estimate`.
   function start_diagnostics(b, x, guess, s, found, singular) result(list)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(guess_t), intent(in) :: guess     !< the initial guess, and how each block's position was chosen
      type(state_t), intent(in) :: s         !< the first motion
      type(motion_t), intent(in) :: found    !< of its links
      logical, intent(in) :: singular        !< some Jacobian has no inverse
      type(diagnostic_t), allocatable :: list(:)   !< (any number)
      real(wp) :: off(size(found%position, 2))
      type(diagnostic_t) :: r
      integer, allocatable :: rows(:)
      integer :: k, link, same

      allocate (list(0))
      if (b%redundant > 0) then
         ! Each pair and drive with redundant equations once, with their number.
         rows = redundant_rows(b, x, 1, s)
         do k = size(rows), 1, -1
            r = diagnostic_t(kind=diagnostic_redundant, pair=b%rows(rows(k))%pair, drive=b%rows(rows(k))%drive)
            same = findloc(list%pair == r%pair .and. list%drive == r%drive, .true., dim=1)
            if (same > 0) list(same)%equations = list(same)%equations + 1
            if (same == 0) list = [list, r]
         end do
      end if

      do k = 1, size(b%needed)
         associate (i => b%needed(k))
            if (b%list(i)%explicit) cycle
            if (singular) then
               call add_mobility(b, x, s, i, list)
               cycle
            end if
            if (guess%choice(i)%is_close) list = [list, new_diagnostic(diagnostic_second, links_of(b, x, i))]
            if (guess%choice(i)%is_incomplete) list = [list, new_diagnostic(diagnostic_incomplete, links_of(b, x, i))]
         end associate
      end do

      off = wrap_angle(found%position(3, :) - guess%links(3, :))
      link = maxloc(abs(off), mask=b%is_found, dim=1)
      if (link == 0) return
      if (abs(off(link)) > far_estimate) list = [list, diagnostic_t(kind=diagnostic_far_estimate, &
         links=[link, 0, 0, 0, 0, 0], is_angle=.true., value=off(link))]
   end function start_diagnostics

   !> Adds a diagnostic about the links that can move in a block although no drive does, and the links that hang from
   !> them, if there are any.
   subroutine add_mobility(b, x, s, i, list)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s         !< with a singular position
      integer, intent(in) :: i               !< the number of the block
      type(diagnostic_t), allocatable, intent(inout) :: list(:)   !< one more, or as before
      logical, allocatable :: moves(:), moved(:)
      integer :: k

      moves = moving_unknowns(b, x, i, s)
      if (.not. any(moves)) return
      associate (block => b%list(i))
         moved = links_with(b, pack(b%unknown(block%first:block%last), moves))
      end associate
      do k = 1, x%chain%wanted
         associate (h => x%chain%links(k))
            if (h%parent > 0) moved(h%link) = moved(h%link) .or. moved(h%parent)
         end associate
      end do
      list = [list, new_diagnostic(diagnostic_mobile, moved)]
   end subroutine add_mobility

   !> Tells which links a block moves (links): those whose angle is an unknown of the block; if there is none, those
   !> whose slide is.
   pure function links_of(b, x, i) result(chosen)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      logical :: chosen(size(b%tree%orientation))
      integer :: k

      associate (unknowns => own_unknowns(b, i))
         chosen = links_with(b, unknowns)
         if (any(chosen)) return
         do k = 1, size(x%chain%links)
            if (any(unknowns == x%chain%links(k)%slide)) chosen(x%chain%links(k)%link) = .true.
         end do
      end associate
   end function links_of

   !> Tells which links have their angle among given unknowns (links).
   pure function links_with(b, unknowns) result(chosen)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: unknowns(:)     !< (any number) their numbers
      logical :: chosen(size(b%tree%orientation))
      integer :: k

      chosen = .false.
      do k = 1, size(unknowns)
         chosen = chosen .or. (b%tree%orientation == unknowns(k) .and. b%tree%orientation > 0)
      end do
   end function links_with

   !> Finds the limit of a motion: the nearest limit of its blocks. Blocks that build on a block come to its limit as
   !> well, at an equal time but for an error of higher order. If the times left of two blocks do not differ by the
   !> factor `much_nearer`, the first in solving order counts.
   function limit_diagnostic(b, x, path, history, s, t, creeps) result(list)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(drive_path_t), intent(in) :: path   !< of the drives
      type(history_t), intent(in) :: history   !< with the last motion accepted; without a motion there is no limit
      type(state_t), intent(in) :: s         !< with the rates of the drives
      real(wp), intent(in) :: t              !< the parameter of the path that could not be reached
      logical, intent(in) :: creeps          !< many substeps have come so near that a slide's infinity may be after `t`
      type(diagnostic_t), allocatable :: list(:)   !< (0 or 1) with links, time, and the first drive and its value
      type(diagnostic_t) :: r
      real(wp) :: left, nearest, f(3)
      logical :: moves(0:size(path%laws))
      integer :: i, d, k

      allocate (list(0))
      if (history%filled == 0) return
      i = 0
      nearest = huge(nearest)
      do k = 1, size(b%moving)
         if (b%list(b%moving(k))%explicit) cycle
         left = time_to_limit(b%moving(k))
         if (abs(left) <= 0.0_wp) left = time_to_infinity(b%moving(k))
         if (abs(left) <= 0.0_wp .or. abs(left) >= much_nearer*abs(nearest)) cycle
         i = b%moving(k)
         nearest = left
      end do
      if (i == 0) return
      r = new_diagnostic(diagnostic_limit, links_of(b, x, i))
      r%in_line = is_in_line(b, x, i, r, history%past%value)
      r%t = history%t(0) + nearest

      ! The first drive that moves the block there, directly or through blocks on which it builds; if all these drives
      ! rest, the first of them.
      moves = .false.
      associate (below => blocks_below(b, i))
         do d = 1, size(below)
            associate (block => b%list(below(d)))
               moves(b%rows(block%first_row:block%last_row)%drive) = .true.
            end associate
         end do
      end associate

      do d = 1, size(path%laws)
         if (.not. moves(d)) cycle
         f = drive_at(path, d, r%t)
         if (r%drive > 0 .and. abs(f(2)) <= 0.0_wp) cycle
         r%drive = d
         r%value = f(1)
         r%is_angle = .not. is_length(path%laws(d))
         if (abs(f(2)) > 0.0_wp) exit
      end do
      list = [r]

   contains

      !> Gives the time from the last motion to the limit t* of a block, if the limit is near; otherwise 0. Close to t*
      !> the fastest unknown x is x* + c sqrt(t* - t): t* - t = x'/(2 x''), with an error of higher order. A block that
      !> is far from singular only follows another block, and has no limit of its own. Near a change point accelerations
      !> may be rounding: no velocity is then much larger than the velocities of the drives.
      pure real(wp) function time_to_limit(i) result(left)
         integer, intent(in) :: i            !< the number of the block
         integer :: fastest

         left = 0.0_wp
         if (history%jacobian(i)%pivot > near_singular_pivot*x%blocks(i)%lipschitz) return
         associate (past => history%past, latest => history%slot(0), step => t - history%t(0), u => own_unknowns(b, i))
            if (size(u) == 0) return
            fastest = u(maxloc(abs(past(u)%acceleration(latest)), dim=1))
            if (abs(past(fastest)%acceleration(latest)) <= 0.0_wp) return
            if (history%uncertain(0) > 0.0_wp .and. &
               maxval(abs(past(u)%rate(latest))) <= much_faster*largest_drive_rate(s)) return
            left = 0.5_wp*past(fastest)%rate(latest)/past(fastest)%acceleration(latest)
            if (left*sign(1.0_wp, step) <= 0.0_wp .or. abs(left) > near_limit_part*abs(step)) left = 0.0_wp
         end associate
      end function time_to_limit

      !> Gives the time from the last motion to the instant t* at which a slide of a block is infinite, since two guides
      !> become parallel; 0 if there is no such instant up to `t`, or after it if `creeps`. Close to t* the slide s is
      !> c/(t* - t) plus a constant: t* - t = 2 s'/s'', and s s''/s'^2 is about 2. The longest slide counts.
      pure real(wp) function time_to_infinity(i) result(left)
         integer, intent(in) :: i            !< the number of the block
         real(wp) :: to_go, longest
         integer :: k

         left = 0.0_wp
         longest = far_slide
         do k = b%list(i)%first, b%list(i)%last
            associate (slide => history%past(b%unknown(k)), latest => history%slot(0), step => t - history%t(0))
               if (b%unknown(k) <= b%orientations .or. .not. abs(slide%rate(latest)) > 0.0_wp) cycle
               if (abs(slide%value) < longest) cycle
               if (abs(slide%value*slide%acceleration(latest)/slide%rate(latest)**2 - 2.0_wp) > pole_tolerance) cycle
               to_go = 2.0_wp*slide%rate(latest)/slide%acceleration(latest)
               if (to_go*sign(1.0_wp, step) <= 0.0_wp) cycle
               if (abs(to_go) > (1.0_wp + near_limit_part)*abs(step) .and. .not. creeps) cycle
               left = to_go
               longest = abs(slide%value)
            end associate
         end do
      end function time_to_infinity

   end function limit_diagnostic

   !> Finds which links have velocities at a singular position, and the kind of the position. It is a dead point if some
   !> block has one, otherwise a change point if some block has one, otherwise unclear. The links of the first such
   !> block are recorded, and whether they are collinear.
   subroutine get_link_flags(b, x, s, all_at_once, found)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s         !< with the singular position
      logical, intent(in) :: all_at_once     !< all equations are solved at once, and have one Jacobian
      type(motion_t), intent(inout) :: found   !< link_known, link_flag, singularity and singular_links are set
      type(diagnostic_t) :: r
      integer :: kinds(size(b%list)), i

      call flag_singular_links(b, x, s, all_at_once, found)
      kinds = classify_blocks(b, x, s)
      found%singularity = max(singular_unclear, maxval(kinds))
      if (maxval(kinds) < 0) return
      i = maxloc(kinds, dim=1)
      r = new_diagnostic(diagnostic_singular, links_of(b, x, i))
      r%in_line = is_in_line(b, x, i, r, s%u%value)
      found%singular_links = r
   end subroutine get_link_flags

   !> Finds the kind of a position for each block (blocks): singular_unclear, ...; -1 if the block is not singular. The
   !> kind is -1 also if the block builds on a singular block: without the velocities there it has no right-hand side.
   function classify_blocks(b, x, s) result(found)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s         !< with the position
      integer :: found(size(b%list))
      integer :: missing(0:b%unknowns), before, k

      found = -1
      missing = 0
      do k = 1, size(b%needed)
         associate (i => b%needed(k))
            before = largest_known(b, i, missing)
            if (before == 0 .and. s%is_singular(i)) found(i) = block_singularity(b, x, i, s)
            missing(own_unknowns(b, i)) = max(before, merge(1, 0, s%is_singular(i)))
         end associate
      end do
   end function classify_blocks

   !> Lists a diagnostic for each block that has a change point at an instant without velocities: each of the two
   !> branches has its own velocities. The list is empty if a block is singular there in another way.
   function change_diagnostics(b, x, s, t) result(list)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s         !< the motion found last, without velocities
      real(wp), intent(in) :: t              !< its time, in the deck's unit
      type(diagnostic_t), allocatable :: list(:)   !< (any number)
      integer :: kinds(size(b%list)), i

      kinds = classify_blocks(b, x, s)
      allocate (list(0))
      if (any(kinds >= 0 .and. kinds /= singular_change)) return
      do i = 1, size(kinds)
         if (kinds(i) == singular_change) list = [list, diagnostic_at_change(b, x, i, t)]
      end do
   end function change_diagnostics

   !> Makes the diagnostic of a change point at an instant.
   type(diagnostic_t) function diagnostic_at_change(b, x, i, t) result(r)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of its block
      real(wp), intent(in) :: t              !< its time, in the deck's unit

      r = new_diagnostic(diagnostic_change, links_of(b, x, i))
      r%t = t
      r%here = .true.
   end function diagnostic_at_change

   !> Tells whether the links of a diagnostic are two that are in line: they share a revolute pair, and all body vectors
   !> that angles of their block rotate are parallel.
   pure logical function is_in_line(b, x, i, diagnostic, value)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(diagnostic_t), intent(in) :: diagnostic   !< with the links that the block moves
      real(wp), intent(in) :: value(0:)      !< (0:unknowns) values, rad or unit of the loop
      real(wp), allocatable :: angle(:)
      integer :: m, k

      is_in_line = count(diagnostic%links > 0) == 2 .and. any([(all(b%joint(:, k) == diagnostic%links(:2)) &
         .or. all(b%joint(:, k) == diagnostic%links(2:1:-1)), k=1, size(b%joint, 2))])
      allocate (angle(0))
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         do k = b%loops(m)%first_own, b%loops(m)%last_vector
            angle = [angle, value(b%body_vectors(k)%orientation) + atan2(x%d(k)%y, x%d(k)%x)]
         end do
      end do
      do k = 2, size(angle)
         is_in_line = is_in_line .and. abs(sin(angle(k) - angle(1))) <= in_line_sine
      end do
   end function is_in_line
end module block_diagnostics
