!> Tests. `check_forms DECK...` checks the closed forms against the decks, with nothing of the solver: at every instant
!> of every set the links of the closed form must satisfy the closure equations of all pairs, stand where the ground
!> links stand, and move as the drives say; and so must their first and second derivatives, by jets in real128.
!> The last line is `N passed, N failed`.
program check_forms
   use failures, only: failure_t
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_t, drive_t, instant_count, instant, pair_revolute, drive_angle, drive_x, &
      drive_y, &
      drive_relangle, drive_slide
   use scales, only: characteristic_length, characteristic_rate
   use structure, only: structure_report_t, find_structure
   use deck, only: read_deck
   use quad_jet, only: qp, jet_t, wrap_angle, operator(+), operator(-), operator(*), sin, cos
   use quad_decks, only: length, angle, law
   use jet_closure, only: numbers_of, closure_jets
   use closed_forms_dyads, only: body_t
   use test_counter, only: test_counter_t, count_one, conclude, deck_name
   use closed_forms, only: closed_form
   use expected_groups, only: count_by_hand
   use expected_links, only: sort_links
   implicit none
   !> Relative; real128 rounds at 1e-34, and six digits are left for the roundings of a chain of dyads.
   real(qp), parameter :: tolerance = 1.0e-28_qp
   character(*), parameter :: order(0:2) = [character(18) :: 'positions', 'velocities', 'accelerations']
   character(500) :: path
   type(test_counter_t) :: counter
   integer :: i

   do i = 1, command_argument_count()
      call get_command_argument(i, path)
      call check_deck(trim(path))
   end do
   call conclude(counter)

contains

   subroutine check_deck(path)
      character(*), intent(in) :: path
      character(:), allocatable :: name, report
      type(mechanism_t), allocatable :: sets(:)
      type(failure_t), allocatable :: failure
      integer :: i

      name = deck_name(path)
      call read_deck(path, sets, report, failure)
      call count_one(counter, .not. allocated(failure), path//': the deck is read')
      if (allocated(failure)) return
      do i = 1, size(sets)
         call check_set(name, sets(i))
      end do
   end subroutine check_deck

   subroutine check_set(name, m)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(body_t) :: links(size(m%links))
      type(jet_t) :: f(size(m%drives)), r(2*size(m%pairs) + size(m%drives))
      real(qp) :: pairs(0:2), grounds(0:2), driven(0:2), t
      character(:), allocatable :: fault
      character(40) :: what
      integer :: i, k

      write (what, '(2a,i0,a)') name, ', set ', m%set_number, ': '
      call count_one(counter, agree(count_by_hand(name), find_structure(m)), &
         trim(what)//' links and pairs as counted by hand')
      pairs = 0.0_qp
      grounds = 0.0_qp
      driven = 0.0_qp
      do k = 0, instant_count(m) - 1
         t = real(instant(m, k), qp)
         call sort_links(m, closed_form(name, m%set_number, t), links, fault)
         if (fault /= '') exit
         f = [(law_of(m, m%drives(i), t), i=1, size(f))]
         r = closure_jets(m, numbers_on_cards(m), links, f)
         call check_pairs(m, links, r, pairs)
         call check_grounds(m, links, grounds)
         call check_drives(m, links, f, r(2*size(m%pairs) + 1:), driven)
      end do
      call count_one(counter, fault == '', trim(what)//' links by name')
      do k = 0, 2
         call count_size(pairs(k), trim(what)//' pairs, '//order(k))
         call count_size(grounds(k), trim(what)//' ground links, '//order(k))
         call count_size(driven(k), trim(what)//' drives, '//order(k))
      end do
   end subroutine check_set

   !> The numbers of the deck that place anything, as `numbers_of` of jet_closure has them, but what stands on the
   !> cards.
   function numbers_on_cards(m) result(d)
      type(mechanism_t), intent(in) :: m
      real(qp), allocatable :: d(:)
      integer :: i, n

      d = 0.0_qp*numbers_of(m)
      n = 3*size(m%links)
      do i = 1, size(m%points)
         d(n + 2*i - 1:n + 2*i) = [length(m%points(i)%offset(1)), length(m%points(i)%offset(2))]
      end do
      n = n + 2*size(m%points)
      do i = 1, size(m%pairs)
         if (m%pairs(i)%kind /= pair_revolute) d(n + 3*i - 2:n + 3*i) = pair_numbers(m, m%pairs(i))
      end do
   end function numbers_on_cards

   !> The residuals `r` of the pairs, two of each.
   subroutine check_pairs(m, links, r, worst)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: links(:)
      type(jet_t), intent(in) :: r(:)
      real(qp), intent(inout) :: worst(0:2)
      integer :: k

      do k = 1, size(m%pairs)
         associate (pair => m%pairs(k))
            if (pair%kind == pair_revolute) then
               call enlarge(worst, r(2*k - 1), size_of(m, links, pair%point_i, pair%point_j))
               call enlarge(worst, r(2*k), size_of(m, links, pair%point_i, pair%point_j))
            else
               call enlarge(worst, r(2*k - 1), guide_size(m, links, pair))
               call enlarge(worst, whole_turns_off(r(2*k)), turn_size(m, links(m%points(pair%point_j)%link)%phi &
                  - links(m%points(pair%point_i)%link)%phi))
            end if
         end associate
      end do
   end subroutine check_pairs

   subroutine check_grounds(m, links, worst)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: links(:)
      real(qp), intent(inout) :: worst(0:2)
      integer :: k
      real(qp) :: one(0:2)

      do k = 1, size(links)
         if (.not. m%links(k)%ground) cycle
         associate (b => links(k), there => m%links(k)%position)
            one = max(real(characteristic_length(m), qp), abs(length(there(1))), abs(length(there(2))))
            call enlarge(worst, b%x - length(there(1)), one)
            call enlarge(worst, b%y - length(there(2)), one)
            call enlarge(worst, whole_turns_off(b%phi - angle(m, there(3))), turn_size(m, b%phi))
         end associate
      end do
   end subroutine check_grounds

   !> The residuals `r` of the drives, whose laws are `f`.
   subroutine check_drives(m, links, f, r, worst)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: links(:)
      type(jet_t), intent(in) :: f(:), r(:)
      real(qp), intent(inout) :: worst(0:2)
      integer :: k

      do k = 1, size(m%drives)
         associate (subject => m%drives(k)%subject)
            select case (m%drives(k)%kind)
            case (drive_angle, drive_relangle)
               call enlarge(worst, whole_turns_off(r(k)), turn_size(m, f(k)))
            case (drive_x, drive_y)
               call enlarge(worst, r(k), size_of(m, links, subject, subject))
            case (drive_slide)
               call enlarge(worst, r(k), guide_size(m, links, m%pairs(subject)))
            end select
         end associate
      end do
   end subroutine check_drives

   !> Alpha, h and beta of a prismatic pair: those of its card or, where these are blank, of the drawing.
   function pair_numbers(m, pair) result(numbers)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair
      real(qp) :: numbers(3), d(2), phi(2)

      numbers = [angle(m, pair%alpha), length(pair%offset), angle(m, pair%beta)]
      d = drawn_place(m, pair%point_j) - drawn_place(m, pair%point_i)
      phi(1) = angle(m, m%links(m%points(pair%point_i)%link)%position(3))
      phi(2) = angle(m, m%links(m%points(pair%point_j)%link)%position(3))
      if (pair%drawn(1)) numbers(1) = atan2(d(2), d(1)) - phi(1)
      if (pair%drawn(2)) numbers(2) = d(1)*sin(phi(1) + numbers(1)) - d(2)*cos(phi(1) + numbers(1))
      if (pair%drawn(3)) numbers(3) = phi(2) - phi(1)
   end function pair_numbers

   !> The law of a drive; its value at t = 0 is that of its card or, where this is blank, of the drawing.
   type(jet_t) function law_of(m, drive, t) result(f)
      type(mechanism_t), intent(in) :: m
      type(drive_t), intent(in) :: drive
      real(qp), intent(in) :: t
      type(drive_t) :: relative
      real(qp) :: d(2), numbers(3)

      f = law(m, drive, t)
      if (.not. drive%drawn) return
      relative = drive
      relative%polynomial(1) = 0.0_wp
      f = law(m, relative, t)
      associate (k => drive%subject)
         select case (drive%kind)
         case (drive_angle)
            f = f + angle(m, m%links(k)%position(3))
         case (drive_relangle)
            f = f + (angle(m, m%links(drive%second)%position(3)) - angle(m, m%links(k)%position(3)))
         case (drive_x, drive_y)
            d = drawn_place(m, k)
            f = f + merge(d(1), d(2), drive%kind == drive_x)
         case default
            d = drawn_place(m, m%pairs(k)%point_j) - drawn_place(m, m%pairs(k)%point_i)
            numbers = pair_numbers(m, m%pairs(k))
            numbers(1) = numbers(1) + angle(m, m%links(m%points(m%pairs(k)%point_i)%link)%position(3))
            f = f + (d(1)*cos(numbers(1)) + d(2)*sin(numbers(1)))
         end select
      end associate
   end function law_of

   !> The place of point number `i` where the cards of the links put it.
   function drawn_place(m, i) result(p)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      real(qp) :: p(2), u(2), phi

      associate (link => m%links(m%points(i)%link))
         u = [length(m%points(i)%offset(1)), length(m%points(i)%offset(2))]
         phi = angle(m, link%position(3))
         p = [length(link%position(1)), length(link%position(2))] &
            + [u(1)*cos(phi) - u(2)*sin(phi), u(1)*sin(phi) + u(2)*cos(phi)]
      end associate
   end function drawn_place

   !> An angle brought to the whole turn next to zero.
   type(jet_t) function whole_turns_off(phi) result(rest)
      type(jet_t), intent(in) :: phi

      rest = jet_t(wrap_angle(phi%v), phi%d, phi%dd)
   end function whole_turns_off

   !> What a difference of two points' places, velocities and accelerations is measured by: the largest term in it, or
   !> the characteristic length and rate.
   function size_of(m, links, i, j) result(one)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: links(:)
      integer, intent(in) :: i, j
      real(qp) :: one(0:2), body_vector
      integer :: k, point

      one = [(characteristic_length(m)*real(characteristic_rate(m, characteristic_length(m)), qp)**k, k=0, 2)]
      do k = 1, 2
         point = merge(i, j, k == 1)
         body_vector = maxval(abs(m%points(point)%offset))
         associate (b => links(m%points(point)%link))
            one(0) = max(one(0), abs(b%x%v), abs(b%y%v), body_vector)
            one(1) = max(one(1), abs(b%x%d), abs(b%y%d), body_vector*abs(b%phi%d))
            one(2) = max(one(2), abs(b%x%dd), abs(b%y%dd), body_vector*b%phi%d**2, body_vector*abs(b%phi%dd))
         end associate
      end do
   end function size_of

   !> The same in a guide that turns.
   function guide_size(m, links, pair) result(one)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: links(:)
      type(pair_t), intent(in) :: pair
      real(qp) :: one(0:2)

      one = size_of(m, links, pair%point_i, pair%point_j)
      associate (phi => links(m%points(pair%point_i)%link)%phi)
         one(2) = one(2) + abs(phi%d)*one(1) + (phi%d**2 + abs(phi%dd))*one(0)
         one(1) = one(1) + abs(phi%d)*one(0)
      end associate
   end function guide_size

   function turn_size(m, phi) result(one)
      type(mechanism_t), intent(in) :: m
      type(jet_t), intent(in) :: phi
      real(qp) :: one(0:2)
      integer :: k

      one = [(real(characteristic_rate(m, characteristic_length(m)), qp)**k, k=0, 2)]
      one = max(one, abs([phi%v, phi%d, phi%dd]))
   end function turn_size

   subroutine enlarge(worst, residual, one)
      real(qp), intent(inout) :: worst(0:2)
      type(jet_t), intent(in) :: residual
      real(qp), intent(in) :: one(0:2)

      worst = max(worst, abs([residual%v, residual%d, residual%dd])/one)
      ! max may pass over a NaN.
      if (.not. all(abs([residual%v, residual%d, residual%dd]) <= huge(1.0_qp))) worst = huge(1.0_qp)
   end subroutine enlarge

   logical function agree(a, b)
      type(structure_report_t), intent(in) :: a, b

      agree = all([a%links, a%ground, a%revolute, a%prismatic, a%coordinates, a%equations, a%degrees_of_freedom, &
         a%drives] &
         == [b%links, b%ground, b%revolute, b%prismatic, b%coordinates, b%equations, b%degrees_of_freedom, b%drives])
   end function agree

   subroutine count_size(worst, what)
      real(qp), intent(in) :: worst
      character(*), intent(in) :: what
      character(12) :: text

      write (text, '(es12.2)') worst
      call count_one(counter, worst <= tolerance, trim(what)//': relative error'//text)
   end subroutine count_size
end program check_forms
